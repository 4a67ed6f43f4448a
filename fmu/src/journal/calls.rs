//! Calls of an instance in its log: what was asked, as JSON, and what became of it.

use sandgate::component::{Component, VariableTable};
use sandgate::wire::foxglove::LogLevel;
use sandgate::wire::json::number;
use sandgate::wire::messages::{Command, CommandKind};
use sandgate::wire::{Observer, convert};
use serde_json::{Map, Value, json};

use super::Journal;
use crate::asked::{Asked, shown};
use crate::fault::Fault;

/// Variables whose names stand in a request; a refused call may name any number of them.
const MOST_TOLD: usize = 64;

impl Journal {
    /// A call begins.
    pub(crate) fn begin(&mut self, call: &'static str) {
        self.call = call;
        self.told = false;
        self.forget_lost_session();
    }

    /// It asks to step.
    pub(crate) fn asks_step(&mut self, component: &Component, t: f64, h: f64) {
        self.request(component, || json!({"t": number(t), "h": number(h)}));
    }

    /// It asks to set variables.
    pub(crate) fn asks_set(&mut self, component: &Component, references: &[u32], values: &[f64]) {
        self.request(component, || {
            named(component.variables(), references, values)
        });
    }

    /// It asks for what its name and these arguments say.
    pub(crate) fn asks(&mut self, component: &Component, asked: &Asked<'_>) {
        self.request(component, || arguments(component.variables(), asked));
    }

    /// It is going to be refused. Calls that only read have told nothing so far.
    pub(crate) fn refuses(&mut self, component: &Component, asked: &Asked<'_>) {
        if !self.told {
            self.asks(component, asked);
        }
    }

    fn request(&mut self, component: &Component, body: impl FnOnce() -> Value) {
        if self.log.is_some() {
            self.told = true;
            let body = body();
            self.command(component, CommandKind::Request, body, "");
        }
    }

    /// What became of it. Calls that only read are not in the log unless they were refused.
    pub(crate) fn reply(&mut self, component: &Component, result: Result<(), &Fault>) {
        if let Err(fault) = result {
            let line = format!("{}: {fault}", self.call);
            self.line(component, LogLevel::Error, &line);
        }
        if self.log.is_none() || (result.is_ok() && !self.told) {
            return;
        }
        if !self.told {
            self.command(component, CommandKind::Request, json!({}), "");
        }
        let (body, status) = match result {
            Ok(()) => (json!({"ok": true, "time": number(component.time())}), "ok"),
            Err(fault) => (
                json!({"ok": false, "message": fault.to_string()}),
                fault.code(),
            ),
        };
        self.command(component, CommandKind::Reply, body, status);
        self.told = false;
    }

    fn command(&mut self, component: &Component, kind: CommandKind, body: Value, status: &str) {
        let Some(log) = &mut self.log else { return };
        let time = component.time();
        let command = Command {
            timestamp: Some(convert::timestamp(time)),
            time,
            kind: kind as i32,
            interface: self.interface.to_owned(),
            verb: self.call.to_owned(),
            request: String::new(),
            client: String::new(),
            body: body.to_string(),
            status: status.to_owned(),
        };
        log.on_command(&command);
    }

    /// What was told to the importer as a warning.
    pub(crate) fn warning(&mut self, component: &Component, text: &str) {
        self.line(component, LogLevel::Warning, text);
    }

    /// A line for people.
    fn line(&mut self, component: &Component, level: LogLevel, text: &str) {
        self.each(|one, source| one.on_log(component.time(), level, source, text));
    }
}

/// Arguments by name, for requests.
fn arguments(table: &VariableTable, asked: &Asked<'_>) -> Value {
    let name = |reference: &u32| match table.by_reference(*reference) {
        Some(row) => row.name.clone(),
        None => unknown(*reference),
    };
    match asked {
        Asked::Nothing => json!({}),
        Asked::Variables(references) => {
            let told = references.iter().take(MOST_TOLD).map(name);
            json!({"variables": told.collect::<Vec<_>>(), "count": references.len()})
        }
        Asked::Texts(references, texts) => {
            let pairs = references.iter().zip(*texts).take(MOST_TOLD);
            pairs
                .map(|(r, text)| {
                    let name = name(r);
                    let text = json!(shown(&name, text));
                    (name, text)
                })
                .collect()
        }
        Asked::Name(name) => json!({"name": name}),
        Asked::Threads(threads) => json!({"threads": threads}),
        Asked::Times(start, stop) => {
            json!({"start": number(*start), "stop": stop.map_or(Value::Null, number)})
        }
    }
}

fn unknown(reference: u32) -> String {
    format!("unknown reference {reference}")
}

/// Values by name, for requests.
fn named(table: &VariableTable, references: &[u32], values: &[f64]) -> Value {
    let mut rest = values;
    let mut map = Map::new();
    for reference in references {
        let Some(row) = table.by_reference(*reference) else {
            map.insert(unknown(*reference), Value::Null);
            break;
        };
        let (own, others) = rest.split_at(row.len().min(rest.len()));
        rest = others;
        let value = match own {
            [one] => number(*one),
            several => several.iter().map(|v| number(*v)).collect(),
        };
        map.insert(row.name.clone(), value);
    }
    Value::Object(map)
}
