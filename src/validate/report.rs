//! What an analysis says: metrics with their rules, tables, figures, notes.

/// What a computed value is held against.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Rule {
    /// Not judged; the reference, if there is one, stands beside it.
    Report(Option<f64>),
    /// At most this.
    AtMost(f64),
    /// At least this.
    AtLeast(f64),
    /// A reference within so much, absolutely.
    Near(f64, f64),
    /// A reference within a share of it.
    NearShare(f64, f64),
    /// From one value to another, both allowed.
    Between(f64, f64),
}

impl Rule {
    /// The reference value, where the rule has one.
    #[must_use]
    pub fn reference(&self) -> Option<f64> {
        match *self {
            Self::Report(reference) => reference,
            Self::Near(reference, _) | Self::NearShare(reference, _) => Some(reference),
            Self::AtMost(_) | Self::AtLeast(_) | Self::Between(..) => None,
        }
    }

    /// Whether a value obeys; `None` where nothing is judged. What is no number never obeys.
    #[must_use]
    pub fn allows(&self, value: f64) -> Option<bool> {
        match *self {
            Self::Report(_) => None,
            Self::AtMost(most) => Some(value <= most),
            Self::AtLeast(least) => Some(value >= least),
            Self::Near(reference, tolerance) => Some((value - reference).abs() <= tolerance),
            Self::NearShare(reference, share) => {
                Some((value - reference).abs() <= share * reference.abs())
            }
            Self::Between(low, high) => Some((low..=high).contains(&value)),
        }
    }
}

/// Changes below which, summed, what is left outside a tolerance is the model's [1].
pub const MODEL: f64 = 0.03;

/// What became of a metric.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// Inside the tolerance.
    Met,
    /// Outside of it, and shown to be the difference between the model and the source: what was chosen to compute it changes
    /// it by less than [`MODEL`].
    Model,
    /// Outside of it.
    FallsShort,
    /// Not judged.
    Reported,
    /// The runs it needs are missing or failed.
    NoResult,
}

/// One comparison.
#[derive(Clone, Debug, PartialEq)]
pub struct Metric {
    /// What was computed.
    pub what: String,
    /// The value, in `unit`; `None` if the runs it needs are missing or failed.
    pub value: Option<f64>,
    /// Unit; empty for a plain number.
    pub unit: &'static str,
    /// What it is held against, in the same unit.
    pub rule: Rule,
    /// Where the reference comes from and why the tolerance is what it is.
    pub source: String,
    /// By how much spacing, start, sound speed and what else is chosen to compute it change it, summed [1]; `None` where that
    /// was not measured.
    pub changes: Option<f64>,
}

impl Metric {
    /// A metric without unit.
    #[must_use]
    pub fn new(
        what: impl Into<String>,
        value: Option<f64>,
        rule: Rule,
        source: impl Into<String>,
    ) -> Self {
        Self {
            what: what.into(),
            value,
            unit: "",
            rule,
            source: source.into(),
            changes: None,
        }
    }

    /// The same with a unit.
    #[must_use]
    pub fn unit(mut self, unit: &'static str) -> Self {
        self.unit = unit;
        self
    }

    /// The same with what each choice changes [1]; nothing unless all of them are there.
    #[must_use]
    pub fn changed_by(mut self, changes: impl IntoIterator<Item = Option<f64>>) -> Self {
        self.changes = changes.into_iter().map(|c| c.map(f64::abs)).sum();
        self
    }

    /// What became of it.
    #[must_use]
    pub fn verdict(&self) -> Verdict {
        let Some(value) = self.value else {
            return Verdict::NoResult;
        };
        match self.rule.allows(value) {
            None => Verdict::Reported,
            Some(true) => Verdict::Met,
            Some(false) if value.is_finite() && self.changes.is_some_and(|c| c < MODEL) => {
                Verdict::Model
            }
            Some(false) => Verdict::FallsShort,
        }
    }
}

/// A table of a page; cells are Markdown.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Table {
    /// What it shows.
    pub title: String,
    /// Column heads.
    pub head: Vec<String>,
    /// Rows, each as long as the head.
    pub rows: Vec<Vec<String>>,
}

/// A picture of a page.
#[derive(Clone, Debug, PartialEq)]
pub struct Figure {
    /// File name without study and ending, `[a-z0-9_]+`.
    pub name: String,
    /// What it shows.
    pub caption: String,
    /// The picture.
    pub svg: String,
}

/// Everything an analysis says.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Report {
    /// Comparisons, in order.
    pub metrics: Vec<Metric>,
    /// Tables after the comparisons.
    pub tables: Vec<Table>,
    /// Pictures.
    pub figures: Vec<Figure>,
    /// Remarks, one paragraph each: what limits the comparison.
    pub notes: Vec<String>,
}

impl Report {
    /// Number of metrics with a verdict.
    #[must_use]
    pub fn count(&self, verdict: Verdict) -> usize {
        let same = self.metrics.iter().filter(|m| m.verdict() == verdict);
        same.count()
    }
}

/// Four significant digits, for tables.
#[must_use]
pub fn number(value: f64) -> String {
    let size = value.abs();
    if size == 0.0 {
        return "0".to_owned();
    }
    if !(1e-3..1e6).contains(&size) {
        return format!("{value:.2e}");
    }
    let digits = (3.0 - size.log10().floor()).max(0.0) as usize;
    let text = format!("{value:.digits$}");
    if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rules_judge_at_and_beyond_their_limits() {
        let judged = |rule: Rule, value| Metric::new("m", Some(value), rule, "").verdict();
        assert_eq!(judged(Rule::AtMost(1.0), 1.0), Verdict::Met);
        assert_eq!(judged(Rule::AtMost(1.0), 1.01), Verdict::FallsShort);
        assert_eq!(judged(Rule::AtLeast(1.0), 0.99), Verdict::FallsShort);
        assert_eq!(judged(Rule::Near(1.5, 0.05), 1.54), Verdict::Met);
        assert_eq!(judged(Rule::Near(1.5, 0.05), 1.44), Verdict::FallsShort);
        assert_eq!(judged(Rule::NearShare(-2.0, 0.1), -2.19), Verdict::Met);
        assert_eq!(
            judged(Rule::NearShare(-2.0, 0.1), -2.21),
            Verdict::FallsShort
        );
        assert_eq!(judged(Rule::Between(1.0, 2.0), 2.0), Verdict::Met);
        assert_eq!(judged(Rule::Between(1.0, 2.0), 2.1), Verdict::FallsShort);
        assert_eq!(judged(Rule::Report(Some(1.0)), 9.0), Verdict::Reported);
        for rule in [
            Rule::AtMost(1.0),
            Rule::AtLeast(1.0),
            Rule::Near(1.0, 1.0),
            Rule::Between(0.0, 1.0),
        ] {
            assert_eq!(judged(rule, f64::NAN), Verdict::FallsShort);
        }
        assert_eq!(
            Metric::new("m", None, Rule::AtMost(1.0), "").verdict(),
            Verdict::NoResult
        );
    }

    #[test]
    fn what_is_left_is_the_models_where_all_choices_together_change_little() {
        let off = |changes: &[Option<f64>]| {
            Metric::new("m", Some(2.0), Rule::AtMost(1.0), "")
                .changed_by(changes.iter().copied())
                .verdict()
        };
        assert_eq!(off(&[Some(0.014), Some(-0.015)]), Verdict::Model);
        assert_eq!(off(&[Some(0.016), Some(-0.015)]), Verdict::FallsShort);
        assert_eq!(off(&[Some(0.01), None]), Verdict::FallsShort);
        assert_eq!(off(&[Some(f64::NAN)]), Verdict::FallsShort);
        let inside = Metric::new("m", Some(0.5), Rule::AtMost(1.0), "").changed_by([Some(0.0)]);
        assert_eq!(inside.verdict(), Verdict::Met);
        let broken =
            Metric::new("m", Some(f64::NAN), Rule::AtMost(1.0), "").changed_by([Some(0.0)]);
        assert_eq!(broken.verdict(), Verdict::FallsShort);
    }

    #[test]
    fn numbers_have_four_digits() {
        let cases = [
            (0.0, "0"),
            (1.23456, "1.235"),
            (-0.0123456, "-0.01235"),
            (123456.0, "123456"),
            (1e-10, "1.00e-10"),
            (2.0, "2"),
        ];
        for (value, text) in cases {
            assert_eq!(number(value), text);
        }
    }
}
