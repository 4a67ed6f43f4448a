//! The Markdown of a study's page.

use super::{Found, MADE, SUMMARY, Summary};
use crate::validate::report::number;
use crate::validate::{Member, Metric, Outcome, Recording, Report, Rule, Study, Table, Verdict};

/// A study's page.
pub(super) fn text(study: &Study, found: &Found, report: &Report, summary: &Summary) -> String {
    let encoded = serde_json::to_string(summary).unwrap_or_default();
    let mut page = format!("{MADE}\n{SUMMARY}{encoded} -->\n# {}\n\n", study.title);
    let mut add = |paragraph: &str| {
        page.push_str(paragraph.trim_end());
        page.push_str("\n\n");
    };
    add(&format!("**Verdict: {}.**", summary.verdict()));
    if summary.quick {
        add(
            "These are the coarse and few runs of `--quick`: they show that the study works, and judge nothing.",
        );
    }
    if found.outdated > 0 {
        let (there, _) = summary.members;
        add(&format!(
            "**{} of {there} runs are older than the program that wrote this page** (another solver or scene); \
             `sandgate validate {}` computes them again.",
            found.outdated, study.name
        ));
    }
    add(study.about);
    add(&format!(
        "## Against the source\n\n{}",
        metrics(&report.metrics)
    ));
    for figure in &report.figures {
        add(&format!(
            "![{}]({}_{}.svg)\n\n*{}*",
            figure.name, study.name, figure.name, figure.caption
        ));
    }
    for table in &report.tables {
        add(&format!("## {}\n\n{}", table.title, markdown(table)));
    }
    if !report.notes.is_empty() {
        add(&format!("## Remarks\n\n{}", report.notes.join("\n\n")));
    }
    add(&how(study, found, summary));
    page.trim_end().to_owned() + "\n"
}

fn metrics(metrics: &[Metric]) -> String {
    let row = |m: &Metric| {
        let unit = if m.unit.is_empty() {
            String::new()
        } else {
            format!(" {}", m.unit)
        };
        let reference = m.rule.reference();
        let error = m.value.zip(reference).filter(|(_, r)| *r != 0.0);
        vec![
            m.what.clone(),
            m.value
                .map_or("-".to_owned(), |v| format!("{}{unit}", number(v))),
            reference.map_or(String::new(), |r| format!("{}{unit}", number(r))),
            error.map_or(String::new(), |(v, r)| {
                format!("{:+.1} %", 100.0 * (v / r - 1.0))
            }),
            allowed(&m.rule),
            word(m),
            m.source.clone(),
        ]
    };
    let head = [
        "quantity",
        "computed",
        "reference",
        "error",
        "allowed",
        "verdict",
        "source and reason",
    ];
    markdown(&Table {
        title: String::new(),
        head: head.map(str::to_owned).to_vec(),
        rows: metrics.iter().map(row).collect(),
    })
}

fn allowed(rule: &Rule) -> String {
    match *rule {
        Rule::Report(_) => String::new(),
        Rule::AtMost(most) => format!("at most {}", number(most)),
        Rule::AtLeast(least) => format!("at least {}", number(least)),
        Rule::Near(_, tolerance) => format!("+- {}", number(tolerance)),
        Rule::NearShare(_, share) => format!("+- {} %", number(100.0 * share)),
        Rule::Between(low, high) => format!("{} to {}", number(low), number(high)),
    }
}

fn word(metric: &Metric) -> String {
    let changes = metric.changes.map_or(String::new(), |c| {
        format!("; the scheme changes it by {} %", number(100.0 * c))
    });
    match metric.verdict() {
        Verdict::Met => "met".to_owned(),
        Verdict::Model => format!("the model's{changes}"),
        Verdict::FallsShort => format!("**falls short**{changes}"),
        Verdict::Reported => "reported".to_owned(),
        Verdict::NoResult => "**no result**".to_owned(),
    }
}

pub(super) fn markdown(table: &Table) -> String {
    let line = |cells: &[String]| format!("| {} |\n", cells.join(" | "));
    let rule = vec!["---".to_owned(); table.head.len()];
    let rows: String = table.rows.iter().map(|row| line(row)).collect();
    format!("{}{}{rows}", line(&table.head), line(&rule))
}

/// How the page was made: command, sources, one line a member.
fn how(study: &Study, found: &Found, summary: &Summary) -> String {
    let quick = if summary.quick { " --quick" } else { "" };
    let (there, all) = summary.members;
    let threads = found.there().map(|(_, r)| r.threads).max().unwrap_or(1);
    // GitHub and rustdoc fold the table; elsewhere it is simply a table.
    format!(
        "## How it was computed\n\n`sandgate validate {}{quick}`, {there} of {all} runs, {} s of CPU time, {} a \
         run; at most {} particles. Sources (hash of what can change a result): {}.\n\n\
         <details><summary>All runs</summary>\n\n{}\n</details>",
        study.name,
        number(summary.cpu),
        match threads {
            0 | 1 => "one thread".to_owned(),
            n => format!("up to {n} threads"),
        },
        summary.particles,
        if summary.sources.is_empty() {
            "none".to_owned()
        } else {
            summary.sources.join(", ")
        },
        markdown(&runs(found))
    )
}

fn runs(found: &Found) -> Table {
    let head = [
        "run",
        "outcome",
        "particles",
        "simulated [s]",
        "steps",
        "CPU [s]",
    ];
    let rows = found.members.iter().zip(&found.recordings);
    Table {
        title: String::new(),
        head: head.map(str::to_owned).to_vec(),
        rows: rows.map(|(m, r)| run(m, r.as_ref())).collect(),
    }
}

/// A row of that table.
fn run(member: &Member, recording: Option<&Recording>) -> Vec<String> {
    let Some(r) = recording else {
        let mut row = vec![member.name.clone(), "not run".to_owned()];
        row.resize(6, String::new());
        return row;
    };
    let outcome = match &r.outcome {
        Outcome::Failed(why) => {
            format!("failed: {}", why.replace('|', "/").replace('\n', " "))
        }
        Outcome::Finished => "finished".to_owned(),
        Outcome::Running => "under way".to_owned(),
    };
    vec![
        member.name.clone(),
        outcome,
        r.particles.to_string(),
        number(r.time.last().copied().unwrap_or(0.0)),
        r.steps.to_string(),
        number(r.cpu),
    ]
}
