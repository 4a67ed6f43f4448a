//! Saved states under strain: roll-backs in any order go on with the same bits, and bad bytes do no harm.

use std::time::{Duration, Instant};

use sandgate::component::Component;
use sandgate::scene;
use sha2::{Digest, Sha256};

/// Material rests behind a gate and sleeps, until it collapses through the gate and is fed.
const SCENE: &str = r#"
name = "states"
dimension = 2

[domain]
lower = ["-30 mm", "-30 mm"]
upper = ["160 mm", "100 mm"]

[numerics]
spacing = "5 mm"
jitter = 0

[materials.beads]
law = "mu_i"
preset = "glass_beads"
grain_diameter = "1 mm"

[bodies.heap]
material = "beads"
box = { lower = [0, 0], upper = ["60 mm", "40 mm"] }

[walls.bed]
polyline = [[0, "80 mm"], [0, 0], ["120 mm", 0]]

[inflows.feed]
material = "beads"
from = ["30 mm", "85 mm"]
to = ["10 mm", "85 mm"]
velocity = [0, "-0.4 m/s"]

[gates.sluice]
from = ["60 mm", 0]
to = ["60 mm", "50 mm"]

[outflows.end]
lower = ["125 mm", "-30 mm"]
upper = ["160 mm", "100 mm"]

[gauges.past]
kind = "discharge"
from = ["90 mm", 0]
to = ["90 mm", "60 mm"]

[gauges.surface]
kind = "profile"
from = ["5 mm", 0]
to = ["65 mm", 0]
count = 4

[run]
step = "10 ms"
until = "1 s"
"#;

/// Steps of the run; before the last part nothing is asked for.
const STEPS: usize = 130;
const REST: std::ops::Range<usize> = 0..100;
const H: f64 = 0.01;

fn component() -> Component {
    let scene = scene::parse("states.toml", SCENE).unwrap_or_else(|why| panic!("{why}"));
    Component::new(&scene).unwrap_or_else(|why| panic!("{why}"))
}

/// The k-th step of the run.
fn step(component: &mut Component, k: usize) {
    let find = |name: &str| component.variables().by_name(name).unwrap().reference;
    let references = [find("gate.sluice.opening"), find("inflow.feed.rate")];
    let values = if REST.contains(&k) {
        [0.0, 0.0]
    } else {
        [[0.0, 0.3, 0.8][k % 3], [0.5, 0.0, 1.5, 1.0][k % 4]]
    };
    component.set(&references, &values).unwrap();
    component.do_step(component.time(), H).unwrap();
}

/// Numbers that look random and are the same on every machine (splitmix64).
struct Dice(u64);

impl Dice {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    fn below(&mut self, end: usize) -> usize {
        (self.next() % end as u64) as usize
    }
}

#[test]
fn two_hundred_random_roll_backs_go_on_with_the_same_bits() {
    let mut first = component();
    first.initialize(0.0, None).unwrap();
    let mut states = vec![first.save().unwrap()];
    let mut asleep = Vec::new();
    for k in 0..STEPS {
        step(&mut first, k);
        states.push(first.save().unwrap());
        asleep.push(first.particles().asleep[0] == 1);
    }
    assert!(asleep.contains(&true), "the scene never sleeps");
    assert!(!asleep[STEPS - 1], "the scene does not wake");
    let changes = asleep.windows(2).filter(|pair| pair[0] != pair[1]).count();
    assert!(changes >= 2, "{changes} changes between sleep and motion");
    let mut instances = [first, component(), component()];
    let mut dice = Dice(7);
    for roll in 0..200 {
        let instance = &mut instances[roll % 3];
        let from = dice.below(STEPS);
        instance.restore(&states[from]).unwrap();
        for k in from..(from + 1 + dice.below(3)).min(STEPS) {
            step(instance, k);
            let found = instance.save().unwrap();
            let differs = |(a, b): (&u8, &u8)| a != b;
            let place = found[84..]
                .iter()
                .zip(&states[k + 1][84..])
                .position(differs);
            assert!(
                found == states[k + 1],
                "roll-back {roll} to step {from} (asleep: {}): another state after step {k} (asleep: {}), first at \
                 byte {place:?} of {} with {:?} bytes of life",
                from > 0 && asleep[from - 1],
                asleep[k],
                found.len() - 84,
                &found[84..88]
            );
        }
    }
}

/// Of a scene that slept through a step less is copied.
#[test]
fn what_is_kept_before_each_step_is_the_state_asleep_or_awake() {
    let mut walker = component();
    walker.initialize(0.0, None).unwrap();
    let mut slept = 0;
    for k in 0..STEPS {
        let before = walker.save().unwrap();
        walker.keep();
        step(&mut walker, k);
        if k % 3 == 1 {
            assert!(walker.back_to_kept());
            assert!(walker.save().unwrap() == before, "before step {k}");
            walker.keep();
            step(&mut walker, k);
        }
        slept += usize::from(walker.particles().asleep[0] == 1);
    }
    assert!(slept > 3, "{slept} steps asleep");
    // What was kept before another state was restored is no way back.
    let other = component().save().unwrap();
    walker.restore(&other).unwrap();
    assert!(!walker.back_to_kept());
}

/// A state whose header and checksum are right, whatever its payload.
fn sealed(good: &[u8], payload: &[u8]) -> Vec<u8> {
    let mut bytes = good[..44].to_vec();
    bytes.extend((payload.len() as u64).to_le_bytes());
    let mut sum = Sha256::new();
    sum.update(&bytes);
    sum.update(payload);
    bytes.extend(sum.finalize().iter());
    bytes.extend(payload);
    bytes
}

#[test]
fn five_hundred_bad_states_are_refused_without_harm() {
    let mut instance = component();
    instance.initialize(0.0, None).unwrap();
    for k in 70..74 {
        step(&mut instance, k);
    }
    let good = instance.save().unwrap();
    assert!(
        sealed(&good, &good[84..]) == good,
        "the layout of states changed"
    );
    let foreign = SCENE.replacen("\"1 mm\"", "\"1.1 mm\"", 1);
    let foreign = scene::parse("foreign.toml", &foreign).unwrap();
    let foreign = Component::new(&foreign).unwrap().save().unwrap();
    let mut dice = Dice(11);
    let mut bad: Vec<Vec<u8>> = Vec::new();
    for _ in 0..200 {
        let mut bytes = good.clone();
        bytes[dice.below(good.len())] ^= 1 << dice.below(8);
        bad.push(bytes);
    }
    for _ in 0..100 {
        bad.push(good[..dice.below(good.len())].to_vec());
        let length = dice.below(4000);
        bad.push((0..length).map(|_| dice.next() as u8).collect());
    }
    for version in (0..51).filter(|version| *version != good[8]) {
        let mut bytes = good.clone();
        bytes[8] = version;
        bad.push(bytes);
    }
    // Whole to the checksum, and all the same no state.
    for _ in 0..48 {
        let payload = &good[84..];
        bad.push(sealed(&good, &payload[..dice.below(payload.len())]));
    }
    bad.push(sealed(&good, &[good[84..].to_vec(), vec![0]].concat()));
    bad.push(foreign);
    assert_eq!(bad.len(), 500);
    // Times that are no number: of the component and of the solver.
    let time = instance.time().to_le_bytes();
    let places = (84..good.len() - 8).filter(|&at| good[at..at + 8] == time);
    for at in places.collect::<Vec<_>>() {
        let mut payload = good[84..].to_vec();
        payload[at - 84..at - 76].copy_from_slice(&f64::NAN.to_le_bytes());
        bad.push(sealed(&good, &payload));
    }
    assert!(bad.len() > 501, "{} places", bad.len() - 500);
    for (i, bytes) in bad.iter().enumerate() {
        let begin = Instant::now();
        let checked = instance.check_saved(bytes).unwrap_err().to_string();
        let refused = instance.restore(bytes).unwrap_err().to_string();
        assert!(begin.elapsed() < Duration::from_secs(1), "blob {i}");
        assert!(refused.starts_with("saved state refused: "), "{refused}");
        assert_eq!(checked, refused);
        if i % 25 == 0 {
            assert!(instance.save().unwrap() == good, "blob {i} did harm");
        }
    }
    assert!(instance.save().unwrap() == good);
    instance.check_saved(&good).unwrap();
    step(&mut instance, 74);
}

/// Instances do not know each other: interleaved and on four threads they give the bits of a lone run.
#[test]
fn instances_beside_each_other_give_the_bits_of_a_lone_run() {
    let run = |count: usize| {
        let mut instance = component();
        instance.initialize(0.0, None).unwrap();
        (70..70 + count).for_each(|k| step(&mut instance, k));
        instance.save().unwrap()
    };
    let alone = run(12);
    let mut pair = [component(), component()];
    for instance in &mut pair {
        instance.initialize(0.0, None).unwrap();
    }
    for k in 70..82 {
        for instance in &mut pair {
            step(instance, k);
        }
    }
    for instance in &pair {
        assert!(instance.save().unwrap() == alone);
    }
    let threads: Vec<_> = (0..4)
        .map(|_| std::thread::spawn(move || run(12)))
        .collect();
    for thread in threads {
        assert!(thread.join().unwrap() == alone);
    }
}

/// Fixed parameters decide what particles keep: a state saved with some set is one of the scene's, whichever the instance that is asked has.
#[test]
fn states_of_other_parameters_are_known_before_they_are_restored() {
    let text = r#"
name = "clay"
[domain]
lower = [0, 0]
upper = ["60 mm", "60 mm"]
[numerics]
spacing = "5 mm"
[materials.clay]
law = "fluid"
density = 1500
consistency = 5
[bodies.block]
material = "clay"
box = { lower = [0, 0], upper = ["30 mm", "30 mm"] }
[walls.bed]
polyline = [[0, "60 mm"], [0, 0], ["60 mm", 0]]
slip = "friction"
wall_friction = 0.4
[run]
step = "10 ms"
until = "1 s"
"#;
    let new = || Component::new(&scene::parse("clay.toml", text).unwrap()).unwrap();
    for (name, value) in [
        ("material.clay.yield_stress", 20.0),
        ("wall.bed.friction", 0.0),
    ] {
        let mut saved = new();
        let reference = saved.variables().by_name(name).unwrap().reference;
        saved.set(&[reference], &[value]).unwrap();
        saved.initialize(0.0, None).unwrap();
        saved.do_step(0.0, H).unwrap();
        let bytes = saved.save().unwrap();
        let mut other = new();
        other.check_saved(&bytes).unwrap();
        other.restore(&bytes).unwrap();
        assert!(other.save().unwrap() == bytes, "{name}");
    }
}
