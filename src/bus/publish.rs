//! What happens to a component → messages for publication, handed to the publishing thread's bounded queue.
//!
//! An [`Observer`] like the log: it runs on the stepping thread, so it never waits. What a full queue has no room for is
//! counted; sequence numbers go on, so that a subscriber sees the gap. Does not know Zenoh.

use super::queue::Giver;
use super::status::{Shared, lock};
use crate::component::{self, Component, StepReport, ValueReference};
use crate::wire::convert::{self, Output};
use crate::wire::foxglove::{FrameTransform, Log, LogLevel, PointCloud, SceneUpdate};
use crate::wire::messages::{Applied, AppliedEvent, Command, Gauge, StepStats};
use crate::wire::picture::scene_update;
use crate::wire::{Described, Moment, Observer, Pending, keys, schema};
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::sync::{Arc, Mutex};

/// Something to publish.
#[derive(Clone, Debug)]
pub(super) struct Publication {
    pub(super) key: Arc<str>,
    /// Name of the protobuf message: `sandgate.Gauge`.
    pub(super) schema: Cow<'static, str>,
    pub(super) bytes: Arc<Vec<u8>>,
}

/// The last publication at each key, for those who come late.
pub(super) type LastValues = Mutex<BTreeMap<Arc<str>, Publication>>;

/// Makes publications.
pub(super) struct Publisher {
    base: String,
    outputs: Vec<(Arc<str>, Output)>,
    pending: Pending,
    /// What was drawn of the scene when it was last published.
    drawn: Option<SceneUpdate>,
    /// Counts batches: every output is published once a batch.
    sequence: u64,
    queue: Giver,
    last: Arc<LastValues>,
    particles_wanted: Arc<AtomicBool>,
    shared: Arc<Shared>,
    /// Whether it has been told that something cannot be read.
    warned: bool,
}

impl Publisher {
    pub(super) fn new(
        base: &str,
        component: &Component,
        queue: Giver,
        last: Arc<LastValues>,
        particles_wanted: Arc<AtomicBool>,
        shared: Arc<Shared>,
    ) -> Self {
        let outputs = convert::outputs(component.variables())
            .into_iter()
            .map(|output| (keys::output(base, &output.name).into(), output))
            .collect();
        Self {
            base: base.to_owned(),
            outputs,
            pending: Pending::default(),
            drawn: None,
            sequence: 0,
            queue,
            last,
            particles_wanted,
            shared,
            warned: false,
        }
    }

    /// Remembers the batch for those who come late, and hands it on.
    fn send(&self, batch: Vec<Publication>) {
        self.send_and(batch, |_| {});
    }

    /// As [`send`](Self::send), after `forget` has taken out what no longer holds.
    fn send_and(
        &self,
        batch: Vec<Publication>,
        forget: impl FnOnce(&mut BTreeMap<Arc<str>, Publication>),
    ) {
        let mut last = lock(&self.last);
        forget(&mut last);
        for publication in &batch {
            last.insert(publication.key.clone(), publication.clone());
        }
        drop(last);
        let lost = self.queue.give(batch);
        self.shared.dropped_publications.fetch_add(lost, Relaxed);
    }

    /// Tells once that a component's own variables cannot be read, which is a defect: what is published lacks them.
    pub(super) fn tell_unread(&mut self, time: f64, error: &component::Error) {
        if !std::mem::replace(&mut self.warned, true) {
            let text = format!("outputs are missing here: {error}");
            self.on_log(time, LogLevel::Error, "bus", &text);
        }
    }

    /// All outputs, the figures of the solver, where gates and moving walls are, and the particles if somebody wants them.
    fn outputs(&mut self, component: &Component, report: Option<&StepReport>) -> Vec<Publication> {
        let step = component.communication_steps();
        let sequence = self.sequence;
        self.sequence += 1;
        let mut batch = Vec::new();
        let mut unread = None;
        for (key, output) in &self.outputs {
            match convert::gauge(component, output, step, sequence) {
                Ok(gauge) => batch.push(publication::<Gauge>(key.clone(), &gauge)),
                Err(error) => unread = Some(error),
            }
        }
        let stats: StepStats = convert::step_stats(component, report, sequence);
        batch.push(publication(keys::stats(&self.base).into(), &stats));
        match convert::frames(component) {
            Ok(frames) => batch.extend(frames.iter().map(|frame: &FrameTransform| {
                let key = keys::frame(&self.base, &frame.child_frame_id);
                publication(key.into(), frame)
            })),
            Err(error) => unread = Some(error),
        }
        if let Some(error) = unread {
            self.tell_unread(component.time(), &error);
        }
        if self.particles_wanted.load(Relaxed) {
            let cloud: PointCloud = convert::point_cloud(component);
            batch.push(publication(keys::particles(&self.base).into(), &cloud));
        }
        batch
    }

    /// The scene at simulated time `time` [s].
    fn scene(&mut self, component: &Component, time: f64) -> Publication {
        self.drawn = Some(scene_update(component.scene(), 0.0));
        let scene = scene_update(component.scene(), time);
        publication(keys::scene(&self.base).into(), &scene)
    }

    fn applied(
        &mut self,
        event: AppliedEvent,
        step: u64,
        t: f64,
        h: f64,
        source: &str,
    ) -> Publication {
        let message: Applied = self.pending.applied(event, step, (t, h), source);
        publication(keys::applied(&self.base).into(), &message)
    }
}

/// The schema (a serialised `FileDescriptorSet`) of every message that is published, by the message's name.
pub(super) fn schemas() -> Vec<(&'static str, Vec<u8>)> {
    fn of<M: Described>() -> (&'static str, Vec<u8>) {
        (M::FULL_NAME, schema::<M>())
    }
    vec![
        of::<Gauge>(),
        of::<StepStats>(),
        of::<Applied>(),
        of::<Log>(),
        of::<PointCloud>(),
        of::<FrameTransform>(),
        of::<SceneUpdate>(),
    ]
}

fn publication<M: prost::Message + Described>(key: Arc<str>, message: &M) -> Publication {
    Publication {
        key,
        schema: M::FULL_NAME.into(),
        bytes: Arc::new(message.encode_to_vec()),
    }
}

impl Observer for Publisher {
    fn on_initialize(
        &mut self,
        component: &Component,
        start: f64,
        stop: Option<f64>,
        source: &str,
    ) {
        let event = AppliedEvent::Initialize;
        let applied = self.applied(event, 0, start, stop.unwrap_or(f64::NAN), source);
        let mut batch = self.outputs(component, None);
        batch.insert(0, applied);
        batch.push(self.scene(component, start));
        self.send(batch);
    }

    fn on_input(
        &mut self,
        component: &Component,
        references: &[ValueReference],
        values: &[f64],
        source: &str,
    ) {
        self.pending.set(component, references, values, source);
    }

    fn on_slopes(&mut self, c: &Component, inputs: &[ValueReference], slopes: &[f64], who: &str) {
        self.pending.slopes(c, inputs, slopes, who);
    }

    fn on_moment(&mut self, component: &Component, moment: &Moment, source: &str) {
        self.pending.moment(component, moment, source);
    }

    fn on_failed_step(&mut self) {
        self.pending.forget_moments();
    }

    fn on_step(
        &mut self,
        component: &Component,
        report: &StepReport,
        t: f64,
        h: f64,
        source: &str,
    ) {
        let step = component.communication_steps();
        let applied = self.applied(AppliedEvent::Step, step, t, h, source);
        let mut batch = self.outputs(component, Some(report));
        batch.insert(0, applied);
        self.send(batch);
    }

    fn on_command(&mut self, _: &Command) {}

    fn on_reply(&mut self, _: &Command) {}

    fn on_jump(&mut self, component: &Component, event: AppliedEvent, source: &str) {
        self.pending.clear();
        let step = component.communication_steps();
        let applied = self.applied(event, step, component.time(), f64::NAN, source);
        let mut batch = self.outputs(component, None);
        batch.insert(0, applied);
        // Fixed parameters may be others there, and walls and gauges elsewhere.
        if self.drawn != Some(scene_update(component.scene(), 0.0)) {
            batch.push(self.scene(component, component.time()));
        }
        // Particles are of the time before, unless somebody wanted them now; lines for people stay true.
        let particles = keys::particles(&self.base);
        self.send_and(batch, |last| drop(last.remove(particles.as_str())));
    }

    fn on_log(&mut self, time: f64, level: LogLevel, name: &str, message: &str) {
        let line = Log {
            timestamp: Some(convert::timestamp(time)),
            level: level as i32,
            message: message.to_owned(),
            name: name.to_owned(),
            file: String::new(),
            line: 0,
        };
        self.send(vec![publication(keys::log(&self.base).into(), &line)]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bus::queue::queue;
    use crate::bus::status::Status;
    use prost::Message as _;

    fn component(text: &str) -> Component {
        let scene = crate::scene::parse("scene.toml", text).unwrap();
        let mut component = Component::new(&scene).unwrap();
        component.initialize(0.0, None).unwrap();
        component
    }

    #[test]
    fn outputs_that_cannot_be_read_are_told_once() {
        let own = component(include_str!("../../tests/scenes/devices.toml"));
        // With fewer variables.
        let other = component(include_str!("../../tests/scenes/small_silo.toml"));
        let (queue, publications) = queue();
        let (last, wanted) = (Arc::default(), Arc::default());
        let shared = Arc::new(Shared::new(Status::of(&own, 0, None)));
        let mut publisher = Publisher::new("base", &own, queue, last, wanted, shared);
        for _ in 0..2 {
            publisher.on_jump(&other, AppliedEvent::Reset, "test");
        }
        publisher.on_jump(&own, AppliedEvent::Reset, "test");
        drop(publisher);
        let lines: Vec<_> = publications
            .flatten()
            .filter(|publication| *publication.key == *keys::log("base"))
            .map(|publication| Log::decode(&publication.bytes[..]).unwrap().message)
            .collect();
        let [line] = &lines[..] else {
            panic!("{lines:?}")
        };
        assert!(line.contains("outputs are missing here"), "{line}");
    }
}
