//! Particles at some times as SVG, coloured by a scalar.
//!
//! A dot is a stroke of no length with round ends, all dots of a colour are one path with relative moves in tenths of a
//! pixel: some eight bytes a particle, so that pictures of thousands of particles can be kept beside a page.

use std::fmt::Write as _;

const WIDTH: f64 = 900.0;
const CAPTION: f64 = 24.0;
const LEGEND: f64 = 40.0;

/// Viridis in eight steps: dark is low.
const COLOURS: [&str; 8] = [
    "#440154", "#46327e", "#365c8d", "#277f8e", "#1fa187", "#4ac16d", "#a0da39", "#fde725",
];

/// Particles at one time.
#[derive(Clone, Debug, PartialEq)]
pub struct Panel {
    /// What stands above it.
    pub caption: String,
    /// x [m], y [m] and the scalar.
    pub particles: Vec<[f32; 3]>,
}

/// Panels below each other, with one scale.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// Lower left corner of each panel [m].
    pub lower: [f64; 2],
    /// Upper right corner [m].
    pub upper: [f64; 2],
    /// Particle spacing: a dot's diameter [m].
    pub spacing: f64,
    /// Value of the brightest colour; the darkest is 0.
    pub most: f64,
    /// What the colours show, with its unit.
    pub label: String,
    /// The panels.
    pub panels: Vec<Panel>,
}

impl Picture {
    /// Draws it.
    #[must_use]
    pub fn svg(&self) -> String {
        let scale = WIDTH / (self.upper[0] - self.lower[0]);
        let tall = scale * (self.upper[1] - self.lower[1]);
        let height = LEGEND + self.panels.len() as f64 * (tall + CAPTION);
        let mut svg = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{WIDTH}\" height=\"{height:.0}\" \
             viewBox=\"0 0 {WIDTH} {height:.0}\" font-family=\"sans-serif\" font-size=\"13\">\n\
             <rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n"
        );
        self.legend(&mut svg);
        for (index, panel) in self.panels.iter().enumerate() {
            let top = LEGEND + index as f64 * (tall + CAPTION);
            // Writing to a string cannot fail.
            let _ = writeln!(
                svg,
                "<text x=\"8\" y=\"{:.0}\">{}</text>",
                top + 16.0,
                panel.caption
            );
            let floor = top + CAPTION + tall + scale * self.lower[1];
            let _ = writeln!(svg, "<path d=\"M0 {floor:.1}H{WIDTH}\" stroke=\"#888\"/>");
            self.dots(&mut svg, panel, scale, floor);
        }
        svg.push_str("</svg>\n");
        svg
    }

    fn legend(&self, svg: &mut String) {
        let _ = writeln!(svg, "<text x=\"8\" y=\"20\">{}: 0</text>", self.label);
        for (index, colour) in COLOURS.iter().enumerate() {
            let x = 240 + 24 * index;
            let _ = writeln!(
                svg,
                "<rect x=\"{x}\" y=\"8\" width=\"24\" height=\"14\" fill=\"{colour}\"/>"
            );
        }
        let most = super::report::number(self.most);
        let _ = writeln!(svg, "<text x=\"440\" y=\"20\">{most} and more</text>");
    }

    fn dots(&self, svg: &mut String, panel: &Panel, scale: f64, floor: f64) {
        let mut paths = vec![String::new(); COLOURS.len()];
        let mut last = vec![(0_i64, 0_i64); COLOURS.len()];
        for [x, y, value] in &panel.particles {
            let share = f64::from(*value) / self.most * COLOURS.len() as f64;
            let class = share.clamp(0.0, COLOURS.len() as f64 - 1.0) as usize;
            let at = (
                (10.0 * scale * (f64::from(*x) - self.lower[0])).round() as i64,
                (-10.0 * scale * f64::from(*y)).round() as i64,
            );
            let _ = write!(
                paths[class],
                "m{} {}h0",
                at.0 - last[class].0,
                at.1 - last[class].1
            );
            last[class] = at;
        }
        let width = (10.0 * scale * self.spacing).max(10.0);
        let _ = writeln!(
            svg,
            "<g transform=\"translate(0 {floor:.1}) scale(.1)\" fill=\"none\" stroke-width=\"{width:.0}\" stroke-linecap=\"round\">"
        );
        for (path, colour) in paths
            .iter()
            .zip(COLOURS)
            .filter(|(path, _)| !path.is_empty())
        {
            let _ = writeln!(svg, "<path stroke=\"{colour}\" d=\"M0 0{path}\"/>");
        }
        svg.push_str("</g>\n");
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_particle_lands_where_it_is_and_in_its_colour() {
        let picture = Picture {
            lower: [-1.0, 0.0],
            upper: [1.0, 0.5],
            spacing: 0.01,
            most: 2.0,
            label: "speed [m/s]".to_owned(),
            panels: vec![Panel {
                caption: "t = 0".to_owned(),
                particles: vec![[0.0, 0.1, 0.0], [0.5, 0.0, 1.1], [0.5, 0.2, 99.0]],
            }],
        };
        let svg = picture.svg();
        // 450 pixels a metre, tenths of a pixel: x = 0 is 4500 from the left, y = 0.1 is 450 up.
        assert!(
            svg.contains("stroke=\"#440154\" d=\"M0 0m4500 -450h0\""),
            "{svg}"
        );
        assert!(
            svg.contains("stroke=\"#1fa187\" d=\"M0 0m6750 0h0\""),
            "{svg}"
        );
        assert!(
            svg.contains("stroke=\"#fde725\" d=\"M0 0m6750 -900h0\""),
            "{svg}"
        );
    }
}
