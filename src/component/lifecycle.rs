//! Which call is allowed in which mode: the one table. Adapters hold no rule of their own.

use super::{Error, Mode};

/// A call of the interface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Call {
    EnterInitialization,
    ExitInitialization,
    SetInput,
    SetTunable,
    SetFixed,
    DoStep,
    GetDerivatives,
    Terminate,
}

/// Modes in the order of the columns below.
const MODES: [Mode; 5] = [
    Mode::Instantiated,
    Mode::Initialization,
    Mode::Stepping,
    Mode::Terminated,
    Mode::Failed,
];

const YES: bool = true;
const NO: bool = false;

/// get, save, restore and reset are allowed in every mode and have no row.
#[rustfmt::skip]
const TABLE: [(Call, &str, [bool; 5]); 8] = [
    //                                                    Instantiated  Initialization  Stepping  Terminated  Failed
    (Call::EnterInitialization, "enter_initialization",      [YES,          NO,             NO,       NO,         NO]),
    (Call::ExitInitialization,  "exit_initialization",       [NO,           YES,            NO,       NO,         NO]),
    (Call::SetInput,            "set of an input",           [YES,          YES,            YES,      NO,         NO]),
    (Call::SetTunable,          "set of a tunable parameter", [YES,         YES,            YES,      NO,         NO]),
    (Call::SetFixed,            "set of a fixed parameter",  [YES,          YES,            NO,       NO,         NO]),
    (Call::DoStep,              "do_step",                   [NO,           NO,             YES,      NO,         NO]),
    (Call::GetDerivatives,      "get_output_derivatives",    [NO,           NO,             YES,      YES,        YES]),
    (Call::Terminate,           "terminate",                 [NO,           NO,             YES,      NO,         YES]),
];

/// Whether `call` may come in `mode`.
///
/// # Errors
/// [`Error::NotAllowedNow`] with the modes in which it may.
pub(super) fn check(call: Call, mode: Mode) -> Result<(), Error> {
    for (row, name, allowed) in TABLE {
        let mut modes = MODES.iter().zip(allowed);
        if row == call && !modes.any(|(m, yes)| yes && *m == mode) {
            let names: Vec<String> = MODES
                .iter()
                .zip(allowed)
                .filter(|(_, yes)| *yes)
                .map(|(m, _)| format!("{m:?}"))
                .collect();
            return Err(Error::NotAllowedNow {
                call: name.to_owned(),
                mode,
                allowed: names.join(" or "),
            });
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn refusal_names_call_mode_and_remedy() {
        let error = check(Call::DoStep, Mode::Terminated).unwrap_err();
        assert_eq!(
            error.to_string(),
            "do_step is not allowed in mode Terminated; allowed in Stepping"
        );
        let error = check(Call::DoStep, Mode::Failed).unwrap_err();
        assert_eq!(
            error.to_string(),
            "do_step is not allowed in mode Failed; allowed in Stepping; a step has failed: restore a saved state or reset"
        );
        let error = check(Call::Terminate, Mode::Instantiated).unwrap_err();
        assert!(error.to_string().ends_with("allowed in Stepping or Failed"));
    }

    #[test]
    fn every_call_has_one_row() {
        for (i, (call, ..)) in TABLE.iter().enumerate() {
            assert_eq!(TABLE.iter().position(|(c, ..)| c == call), Some(i));
        }
    }
}
