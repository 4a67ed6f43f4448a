//! Drives a served silo from Rust: opens its gate, steps it and prints what its gauges say.
//!
//! ```text
//! sandgate serve cases/silo_gate.toml                 # prints where it listens
//! cargo run --release --example bus_client tcp/127.0.0.1:PORT silo_gate
//! ```
//!
//! What `examples/bus_client.py` does, in Rust: requests are JSON on `@rpc/VERB`, gauges arrive as protobuf, whose types the
//! library has in `sandgate::wire::messages`. A program of your own needs the crates `zenoh`, `serde_json`, `prost` and
//! `sandgate`.
#![allow(clippy::print_stdout, reason = "an example talks to whoever runs it")]

use std::collections::BTreeMap;
use std::error::Error;
use std::time::Duration;

use prost::Message as _;
use sandgate::wire::messages::Gauge;
use serde_json::{Value, json};
use zenoh::{Config, Session, Wait as _};

/// Steps to make.
const STEPS: u64 = 10;
/// Length of one [ns].
const STEP: u64 = 5_000_000;
/// How long to wait for a reply: as long as a step may take.
const PATIENCE: Duration = Duration::from_secs(60);

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [endpoint, instance] = &arguments[..] else {
        return Err("usage: bus_client ENDPOINT INSTANCE".into());
    };
    let session = connect(endpoint)?;
    let silo = Component {
        session: &session,
        base: format!("sandgate/v1/{instance}"),
        asked: std::cell::Cell::new(0),
    };
    let gauges = session
        .declare_subscriber(format!("{}/out/gauge/**", silo.base))
        .with(zenoh::handlers::FifoChannel::new(100_000))
        .wait()
        .map_err(|e| e.to_string())?;

    // A set-point, as a PLC would send it; it takes effect with the next step.
    let key = format!("{}/in/gate.main.opening", silo.base);
    session.put(key, "0.5").wait().map_err(|e| e.to_string())?;
    let mut step = 0;
    for _ in 0..STEPS {
        let fields = json!({"dt_ns": STEP, "outputs": ["gate.main.actual_opening"]});
        let reply = silo.ask("step", fields)?;
        step = reply["step"].as_u64().unwrap_or(0);
        if step % STEPS == 0 {
            let opening = &reply["outputs"]["gate.main.actual_opening"];
            println!("step {step}: gate at {opening}");
        }
    }

    // Gauges arrive on their own way: wait for those of the last step.
    let mut last: BTreeMap<String, Gauge> = BTreeMap::new();
    while last.is_empty() || last.values().any(|gauge| gauge.step < step) {
        let Some(sample) = gauges.recv_timeout(PATIENCE).map_err(|e| e.to_string())? else {
            return Err("no gauge arrived".into());
        };
        let gauge = Gauge::decode(sample.payload().to_bytes().as_ref())?;
        last.insert(gauge.name.clone(), gauge);
    }
    for (name, gauge) in &last {
        let values: Vec<String> = gauge.values.iter().map(|v| format!("{v:.4}")).collect();
        println!(
            "t = {:.3} s  {name} = {} {}",
            gauge.time,
            values.join(" "),
            gauge.unit
        );
    }
    let ledger = &silo.ask("status", json!({}))?["ledger"];
    println!(
        "mass present {} kg, account off by {} kg",
        ledger["present"], ledger["error"]
    );
    // What is refused says why, and changes nothing.
    if let Err(why) = silo.ask("set", json!({"inputs": {"gate.main.opening": 1.5}})) {
        println!("{why}");
    }
    session.close().wait().map_err(|e| e.to_string())?;
    Ok(())
}

/// A session that connects to one endpoint and looks for nobody else.
fn connect(endpoint: &str) -> Result<Session, Box<dyn Error>> {
    let mut config = Config::default();
    for (key, value) in [
        ("mode", json!("client")),
        ("connect/endpoints", json!([endpoint])),
        ("scouting/multicast/enabled", json!(false)),
    ] {
        config
            .insert_json5(key, &value.to_string())
            .map_err(|e| e.to_string())?;
    }
    Ok(zenoh::open(config).wait().map_err(|e| e.to_string())?)
}

/// A served component, asked by request and reply.
struct Component<'a> {
    session: &'a Session,
    base: String,
    asked: std::cell::Cell<u64>,
}

impl Component<'_> {
    /// One request. The identifier makes it safe to send the same request again after a time-out.
    fn ask(&self, verb: &str, mut fields: Value) -> Result<Value, Box<dyn Error>> {
        self.asked.set(self.asked.get() + 1);
        // Of this session: in a container the number of the process is the same at each start.
        fields["req"] = json!(format!("{}-{}", self.session.zid(), self.asked.get()));
        fields["client"] = json!("rust-example");
        let replies = self
            .session
            .get(format!("{}/@rpc/{verb}", self.base))
            .payload(fields.to_string())
            .timeout(PATIENCE)
            .wait()
            .map_err(|e| e.to_string())?;
        let Ok(reply) = replies.recv() else {
            return Err(format!("nobody answers at {}", self.base).into());
        };
        let bytes = match reply.result() {
            Ok(sample) => sample.payload().to_bytes(),
            Err(error) => error.payload().to_bytes(),
        };
        let reply: Value = serde_json::from_slice(&bytes)?;
        if reply["ok"] != true {
            let (code, why) = (&reply["code"], &reply["message"]);
            return Err(format!("refused, {}: {}", text(code), text(why)).into());
        }
        Ok(reply)
    }
}

fn text(value: &Value) -> &str {
    value.as_str().unwrap_or_default()
}
