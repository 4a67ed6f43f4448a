//! Bins at rest: wherever walls lie to the lattice and to the domain, the floor bears the weight, and smooth sides nothing along
//! themselves.

use super::Unit;
use sandgate::scene;

const G: f64 = 9.81;
const SPACING: f64 = 0.008;
const HEIGHT: f64 = 0.08;
const SAND: &str = "law = \"constant_friction\"\nfriction_angle = \"25 deg\"\nmatch = \"simple_shear\"\ndensity = 1600";
const BEADS: &str = "law = \"mu_i\"\npreset = \"glass_beads\"";
const WATER: &str = "law = \"fluid\"\npreset = \"water\"";

/// A bin of D dimensions, `width` wide, whose domain ends `margin` behind its walls: a floor without slip and smooth sides, all planes or
/// all boxes that end there.
struct Bin {
    dimensions: usize,
    material: &'static str,
    width: f64,
    margin: f64,
    boxes: bool,
}

impl Bin {
    /// Name and keys of the walls.
    fn walls(&self) -> Vec<(String, String)> {
        let Bin { width, margin, .. } = *self;
        let up = self.dimensions - 1;
        let mut walls = vec![("floor".to_owned(), self.wall(up, 0.0, 1.0, -margin))];
        for k in 0..up {
            for (side, place, inward, end) in [
                ("low", 0.0, 1.0, -margin),
                ("high", width, -1.0, width + margin),
            ] {
                let keys = format!("{}slip = \"free_slip\"\n", self.wall(k, place, inward, end));
                walls.push((format!("{side}_{k}"), keys));
            }
        }
        walls
    }

    /// A wall across axis k at `place`, which goes on to `end` if it is a box.
    fn wall(&self, k: usize, place: f64, inward: f64, end: f64) -> String {
        let all =
            |of: &dyn Fn(usize) -> f64| -> Vec<f64> { (0..self.dimensions).map(of).collect() };
        if !self.boxes {
            let point = all(&|n| if n == k { place } else { 0.0 });
            let normal = all(&|n| if n == k { inward } else { 0.0 });
            return format!("plane = {{ point = {point:?}, normal = {normal:?} }}\n");
        }
        let up = self.dimensions - 1;
        // The floor goes under all sides, the first sides past the ends of the others.
        let span = |n: usize| {
            if n == k {
                return [place.min(end), place.max(end)];
            }
            if n == up {
                return [0.0, 2.0 * HEIGHT];
            }
            if k == up || n > k {
                return [-self.margin, self.width + self.margin];
            }
            [0.0, self.width]
        };
        let (lower, upper) = (all(&|n| span(n)[0]), all(&|n| span(n)[1]));
        format!("box = {{ lower = {lower:?}, upper = {upper:?} }}\n")
    }

    /// The floor's force over the weight, and the largest force of a side along itself over it: means of the last 0.1 of `time` [s].
    fn rest(&self, time: f64) -> [f64; 2] {
        let Bin { width, margin, .. } = *self;
        let corner = |side: f64, top: f64| -> Vec<f64> {
            let mut corner = vec![side; self.dimensions];
            corner[self.dimensions - 1] = top;
            corner
        };
        let walls = self.walls();
        let listed: String = walls
            .iter()
            .map(|(name, keys)| {
                format!("[walls.{name}]\n{keys}[gauges.{name}]\nkind = \"force\"\non = \"wall.{name}\"\n")
            })
            .collect();
        let text = format!(
            "name = \"bin\"\ndimension = {}\n[domain]\nlower = {:?}\nupper = {:?}\n[numerics]\nspacing = {SPACING}\n\
             [materials.m]\n{}\n[bodies.b]\nmaterial = \"m\"\nbox = {{ lower = {:?}, upper = {:?} }}\n{listed}\
             [run]\nstep = 0.01\nuntil = {time}\n",
            self.dimensions,
            corner(-margin, -margin),
            corner(width + margin, 2.0 * HEIGHT),
            self.material,
            corner(0.0, 0.0),
            corner(width, HEIGHT),
        );
        let mut unit = Unit::new(&scene::parse("bin", &text).unwrap());
        unit.run_to(time - 0.1);
        let up = ["x", "y", "z"][self.dimensions - 1];
        let mut forces = vec![0.0; walls.len()];
        for n in 1..=10 {
            unit.run_to(time - 0.1 + 0.01 * f64::from(n));
            for (sum, (name, _)) in forces.iter_mut().zip(&walls) {
                *sum += unit.get(&format!("gauge.{name}.force_{up}")) / 10.0;
            }
        }
        let weight = G * unit.get("mass.present");
        let along = forces[1..].iter().map(|f| f.abs()).fold(0.0, f64::max);
        [-forces[0] / weight, along / weight]
    }
}

/// Rows counted from the domain's corner: with the domain half a spacing aside the floor bore 0.957 of sand and 0.968 of water in the
/// plane, 0.919 of glass beads in space, and the sides what lacked.
#[test]
fn floors_bear_the_weight_wherever_the_domain_ends() {
    let bins = |dimensions, material: &'static str, boxes| {
        let margins = [5.0, 4.75, 4.5].map(|n| n * SPACING);
        let widths = [10.0, 10.5].map(|n| n * SPACING);
        let all = margins.into_iter().flat_map(move |margin| {
            widths.map(|width| Bin {
                dimensions,
                material,
                width,
                margin,
                boxes,
            })
        });
        // In space one of each is enough.
        all.filter(move |bin| dimensions == 2 || bin.margin == 4.5 * SPACING)
    };
    for (dimensions, material, time) in [(2, SAND, 0.6), (2, WATER, 0.6), (3, BEADS, 0.3)] {
        for boxes in [false, true] {
            for bin in bins(dimensions, material, boxes) {
                let [floor, side] = bin.rest(time);
                let told = format!(
                    "{dimensions} dimensions, {}, boxes {boxes}, {:.2} spacings wide, {:.2} behind: floor {floor:.4}, sides {side:.4}",
                    material.lines().last().unwrap_or_default(),
                    bin.width / SPACING,
                    bin.margin / SPACING
                );
                println!("{told}");
                assert!((floor - 1.0).abs() < 0.01, "{told}");
                assert!(side < 0.01, "{told}");
            }
        }
    }
}
