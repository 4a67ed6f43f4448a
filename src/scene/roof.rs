//! What lies under roofs at the start: a culvert, the bottom of a U, a tank that narrows upwards, a bin that leans. What stands above a place
//! there is not what it bears: water at rest has the head of the open water that it is joined to (docs/theory.md, "Start"), and of sand whose
//! pressure is even all round, as it starts, nothing else is at rest between smooth walls.
//!
//! Places under a roof take the pressure that balances them with their neighbours, sum_j [p_i - p_j - rho g (z_j - z_i)] = 0 with rho the mean of
//! both, between the open places, which have that of their depth. Between two tanks of other levels it falls evenly along the way.

use super::load::Loads;
use super::piles::{TOUCH, periods};
use crate::shape::Lattice;
use crate::state::CellGrid;

/// What the balance may be off by, over the largest pressure [1].
const BALANCED: f64 = 1e-9;
const MOST_ITERATIONS: usize = 20_000;

/// A place of a body.
struct Place<const D: usize> {
    body: usize,
    number: usize,
    x: [f64; D],
    density: f64,
    /// That of its depth, and what it comes to under a roof; asked for once a scene is known to have one [Pa].
    pressure: f64,
}

/// Pressures of the places of each body that lie under a roof and are joined to what is open [Pa]; none for the others.
pub(super) fn pressures_under_roofs<const D: usize>(
    loads: &Loads<'_, D>,
    lattices: &[Lattice],
) -> Vec<Vec<Option<f64>>> {
    let mut found: Vec<Vec<Option<f64>>> = vec![Vec::new(); lattices.len()];
    let places = roofed_places(loads, lattices);
    let Some((mut places, roofed)) = places else {
        return found;
    };
    for place in &mut places {
        place.pressure = loads.above(place.body, &lattices[place.body].points[place.number]);
    }
    let neighbours = neighbours(loads, &places, &roofed);
    let joined = joined(&roofed, &neighbours);
    balance(loads, &mut places, &joined, &neighbours);
    for (place, _) in places.iter().zip(&joined).filter(|(_, joined)| **joined) {
        let body = &mut found[place.body];
        body.resize(lattices[place.body].points.len(), None);
        body[place.number] = Some(place.pressure.max(0.0));
    }
    found
}

/// The places of all bodies, and which of them lie under a roof; `None` where none does.
fn roofed_places<const D: usize>(
    loads: &Loads<'_, D>,
    lattices: &[Lattice],
) -> Option<(Vec<Place<D>>, Vec<bool>)> {
    if !loads.has_walls() {
        return None;
    }
    let roofed: Vec<bool> = (0..lattices.len())
        .flat_map(|body| lattices[body].points.iter().map(move |p| (body, p)))
        .map(|(body, point)| loads.under_roof(body, point))
        .collect();
    if !roofed.contains(&true) {
        return None;
    }
    let scene = loads.scene();
    let places = scene.bodies.iter().zip(lattices).enumerate();
    let places = places.flat_map(|(body, (of, lattice))| {
        let density = scene.materials[of.material].material.rest_density();
        let points = lattice.points.iter().enumerate();
        points.map(move |(number, point)| Place {
            body,
            number,
            x: std::array::from_fn(|k| point[k]),
            density,
            pressure: 0.0,
        })
    });
    Some((places.collect(), roofed))
}

/// The places that touch each one under a roof.
fn neighbours<const D: usize>(
    loads: &Loads<'_, D>,
    places: &[Place<D>],
    roofed: &[bool],
) -> Vec<Vec<u32>> {
    let near = TOUCH * loads.scene().numerics.spacing;
    let points: Vec<[f64; D]> = places.iter().map(|p| p.x).collect();
    let cells = CellGrid::build(&points, near, &periods(loads.scene()));
    let of = |(i, x): (usize, &[f64; D])| {
        let mut others = Vec::new();
        if roofed[i] {
            cells.for_each_within(x, near, |j, _, _| {
                if j != i {
                    others.push(j as u32);
                }
            });
        }
        others
    };
    points.iter().enumerate().map(of).collect()
}

/// Which places under a roof are joined to open ones.
fn joined(roofed: &[bool], neighbours: &[Vec<u32>]) -> Vec<bool> {
    let mut joined = vec![false; roofed.len()];
    let open = |i: &usize| neighbours[*i].iter().any(|&j| !roofed[j as usize]);
    let mut next: Vec<usize> = (0..roofed.len()).filter(open).collect();
    while let Some(i) = next.pop() {
        if roofed[i] && !joined[i] {
            joined[i] = true;
            next.extend(neighbours[i].iter().map(|&j| j as usize));
        }
    }
    joined
}

/// Balances the places that are `joined`: conjugate gradients with the number of neighbours as preconditioner.
fn balance<const D: usize>(
    loads: &Loads<'_, D>,
    places: &mut [Place<D>],
    joined: &[bool],
    neighbours: &[Vec<u32>],
) {
    let rows: Vec<usize> = (0..places.len()).filter(|i| joined[*i]).collect();
    let product =
        |d: &[f64], i: usize| -> f64 { neighbours[i].iter().map(|&j| d[i] - d[j as usize]).sum() };
    let weight = |i: usize, j: u32| {
        let (a, b) = (&places[i], &places[j as usize]);
        loads.head(0.5 * (a.density + b.density), &b.x, &a.x)
    };
    let mut pressure: Vec<f64> = places.iter().map(|p| p.pressure).collect();
    let mut residual = vec![0.0; places.len()];
    for &i in &rows {
        let weights: f64 = neighbours[i].iter().map(|&j| weight(i, j)).sum();
        residual[i] = weights - product(&pressure, i);
    }
    let largest = pressure.iter().fold(0.0, |most: f64, p| most.max(*p));
    let most = BALANCED * largest * (rows.len() as f64).sqrt();
    let descent = |residual: &[f64], i: usize| residual[i] / neighbours[i].len() as f64;
    // What is open stays as it is: its direction is 0.
    let mut direction = vec![0.0; places.len()];
    let mut rz: f64 = 0.0;
    for _ in 0..MOST_ITERATIONS {
        if dot_of(&rows, &residual, |i| residual[i]).sqrt() <= most {
            break;
        }
        let next = dot_of(&rows, &residual, |i| descent(&residual, i));
        let beta = if rz > 0.0 { next / rz } else { 0.0 };
        rz = next;
        for &i in &rows {
            direction[i] = descent(&residual, i) + beta * direction[i];
        }
        let products: Vec<f64> = rows.iter().map(|&i| product(&direction, i)).collect();
        let curvature: f64 = rows
            .iter()
            .zip(&products)
            .map(|(&i, q)| direction[i] * q)
            .sum();
        let step = rz / curvature;
        for (&i, q) in rows.iter().zip(&products) {
            pressure[i] += step * direction[i];
            residual[i] -= step * q;
        }
    }
    for &i in &rows {
        places[i].pressure = pressure[i];
    }
}

fn dot_of(rows: &[usize], a: &[f64], b: impl Fn(usize) -> f64) -> f64 {
    rows.iter().map(|&i| a[i] * b(i)).sum()
}
