//! What our FMUs claim, in one list: modelDescription.xml and docs/fmi.md are written from it, and a test looks for every
//! test that is named here.

use std::fmt::Write;

use super::FmiVersion;
use super::xml::Attributes;

/// A capability flag of the standards.
struct Capability {
    /// Attribute of `CoSimulation` in FMI 2; empty if it has none.
    fmi2: &'static str,
    /// The same in FMI 3.
    fmi3: &'static str,
    /// Its value; what equals the standard's default is not written.
    value: &'static str,
    /// What that means here.
    meaning: &'static str,
    /// Tests that prove it.
    proof: &'static [&'static str],
}

const fn claim(
    (fmi2, fmi3): (&'static str, &'static str),
    value: &'static str,
    meaning: &'static str,
    proof: &'static [&'static str],
) -> Capability {
    Capability {
        fmi2,
        fmi3,
        value,
        meaning,
        proof,
    }
}

#[rustfmt::skip]
const CAPABILITIES: &[Capability] = &[
    claim(("canHandleVariableCommunicationStepSize", "canHandleVariableCommunicationStepSize"), "true",
        "any h above 0; t + h is met bit for bit", &["steps_end_where_they_are_told_to"]),
    claim(("canInterpolateInputs", ""), "true",
        "`fmi2SetRealInputDerivatives`, order 1: an input ramps within the next step; FMI 3 sets inputs in intermediate updates",
        &["test_fmi_2_ramps_an_input_within_a_step", "slopes_ramp_inputs_inside_one_step"]),
    claim(("maxOutputDerivativeOrder", "maxOutputDerivativeOrder"), "1",
        "slope of every continuous output over the last steps",
        &["slopes_of_outputs_are_those_of_the_last_points", "every_call_of_fmi_2_in_every_mode", "every_call_of_fmi_3_in_every_mode"]),
    claim(("canGetAndSetFMUstate", "canGetAndSetFMUState"), "true",
        "in every mode, also after an Error; a slot that holds a state is used again",
        &["restored_instances_go_on_with_the_same_bits", "two_hundred_random_roll_backs_go_on_with_the_same_bits", "a_slot_is_used_again_and_freed_once", "every_call_of_fmi_3_in_every_mode"]),
    claim(("canSerializeFMUstate", "canSerializeFMUState"), "true",
        "versioned, with fingerprint and checksum; between processes and into an instance that is only instantiated",
        &["test_a_state_goes_on_in_another_process", "five_hundred_bad_states_are_refused_without_harm", "test_a_state_goes_between_versions"]),
    claim(("", "providesIntermediateUpdate"), "true",
        "after every internal step, from the calling thread: continuous outputs may be read, inputs set",
        &["updates_come_after_internal_steps_and_watching_changes_no_bit", "inputs_set_inside_a_step_count_from_there", "inputs_are_set_inside_a_step_only_if_that_was_asked_for", "other_calls_inside_an_update_are_refused_with_a_message"]),
    claim(("", "canReturnEarlyAfterIntermediateUpdate"), "true",
        "only if the importer allowed it; the time asked for is met bit for bit",
        &["a_step_ends_early_only_if_allowed_and_then_exactly_there"]),
    claim(("", "mightReturnEarlyFromDoStep"), "false",
        "never of its own accord", &["updates_come_after_internal_steps_and_watching_changes_no_bit"]),
    claim(("canBeInstantiatedOnlyOncePerProcess", "canBeInstantiatedOnlyOncePerProcess"), "false",
        "as many instances as memory holds, from several threads",
        &["instances_beside_each_other_give_the_bits_of_a_lone_run", "instances_do_not_know_each_other", "test_going_back_reset_and_a_second_instance"]),
    claim(("needsExecutionTool", "needsExecutionTool"), "false",
        "no file is read at run time: the scene is inside the library; none is written but the log that `log.path` asks for", &["test_the_library_leaves_the_process_as_it_was"]),
    claim(("canNotUseMemoryManagementFunctions", ""), "true",
        "the importer's allocator is never called", &["test_going_back_reset_and_a_second_instance"]),
    claim(("canRunAsynchronuously", ""), "false",
        "a step is done when `fmi2DoStep` returns; `fmi2CancelStep` answers Error", &["every_call_of_fmi_2_in_every_mode"]),
    claim(("", "hasEventMode"), "false",
        "no events, no clocks: the calls exist and answer Error", &["every_call_of_fmi_3_in_every_mode"]),
    claim(("providesDirectionalDerivative", "providesDirectionalDerivatives"), "false",
        "the calls answer Error, as do adjoint derivatives and dependencies of elements",
        &["every_call_of_fmi_2_in_every_mode", "every_call_of_fmi_3_in_every_mode"]),
];

/// Rules that importers impose, how they are kept, and the tests that prove it.
#[rustfmt::skip]
const RULES: &[(&str, &[&str])] = &[
    ("`doStep` answers OK or Error, never Warning, Discard or Fatal; every Error comes with a message that says what was found and what is allowed (but that of a call beside a running one: see Messages)",
        &["refused_calls_leave_no_trace", "every_call_of_fmi_2_in_every_mode", "every_call_of_fmi_3_in_every_mode", "every_call_of_the_c_interface_in_every_mode"]),
    ("a refused call answers within a second and leaves the saved state byte for byte as it was: h = 0, negative, NaN, infinite, denormal, wrong t, past the stop time, unknown references, wrong lengths, inputs that are no number or out of range, fixed parameters after initialisation, every call in every wrong mode",
        &["refused_calls_leave_no_trace", "every_call_of_fmi_2_in_every_mode", "every_call_of_fmi_3_in_every_mode", "every_call_of_the_c_interface_in_every_mode"]),
    ("an input that is out of range by up to a billionth of its range is clamped; beyond, it is refused, or clamped and reported (`logStatusWarning`) if `saturate_inputs` is true",
        &["inputs_are_clamped_only_as_far_as_allowed", "test_clamped_inputs_are_reported"]),
    ("set calls are all or nothing", &["sets_apply_all_or_nothing"]),
    ("a status that FMI 2 has no value for here (pending, integers, texts) is discarded, with a message; only such calls answer Discard",
        &["every_call_of_fmi_2_in_every_mode"]),
    ("getters compute nothing: any order, partition and repetition of references gives the same bits", &["reading_in_any_order_gives_the_same_bits"]),
    ("fixed parameters may be set before and inside initialisation, in any order, and travel in states", &["parameters_count_whenever_they_are_set", "values_that_do_not_go_together_wait_for_each_other"]),
    ("FMI 2 works without `fmi2SetupExperiment`, with parameters set inside initialisation", &["test_fmi_2_without_setup_experiment_and_parameters_in_initialization_mode"]),
    ("the logger is silent while logging is off, may be NULL, is called with the importer's environment pointer from the calling thread; FMI 2's text asks for no arguments",
        &["test_nothing_is_logged_when_logging_is_off", "test_the_logger_is_called_from_the_calling_thread"]),
    ("any form of resource location will do, NULL too: nothing is read from it", &["test_any_resource_location_will_do"]),
    ("directory, locale, environment, signals and floating-point mode stay as they were; no thread outlives an instance; a thousand instances leave no thread and no file open",
        &["test_the_library_leaves_the_process_as_it_was", "test_a_thousand_instances_leave_nothing_behind"]),
    ("importers may trap floating-point exceptions, round another way or take denormals for zero: every call computes as a program starts, with the same bits on any number of threads, and the importer's environment, flags included, is there in its callbacks and afterwards",
        &["an_importer_keeps_its_floating_point_environment_and_gets_the_same_bits"]),
    ("with `log.path` set all traffic is in an MCAP log, roll-backs, slopes and intermediate updates included, and `sandgate log redrive --check` gives the same bits; logging changes none",
        &["test_simulate_fmu_leaves_a_log_that_runs_again", "test_roll_backs_are_in_the_log_and_run_again", "test_slopes_of_inputs_run_again", "test_what_is_done_inside_steps_runs_again", "test_logging_changes_no_bit"]),
    ("a log that cannot begin is refused when initialisation ends, or with the state from which it would begin; one that breaks off is told once, or is an Error of the step if `log.required` is true, and states can be saved all the same; a thousand instances with a log leave no file and no thread open",
        &["test_a_log_that_cannot_begin_is_refused_and_the_path_can_be_corrected", "test_a_state_whose_log_cannot_begin_is_refused_and_changes_nothing", "test_a_full_disk_is_told_once_or_is_an_error", "test_a_run_whose_required_log_broke_off_can_be_rescued", "test_a_thousand_instances_with_a_log_leave_nothing_open"]),
    ("packed with `--zenoh` and with `zenoh.config` set, an FMU publishes and takes set-points while its importer steps it; the importer owns time and wins where both set an input; a thousand instances with log and Zenoh leave no socket, no file and no thread but Zenoh's three",
        &["test_a_client_watches_an_fmu_that_fmpy_steps", "test_publishing_changes_no_bit", "test_set_points_hold_from_the_next_step_but_the_importer_wins", "test_a_thousand_instances_with_log_and_zenoh_leave_what_is_documented"]),
    ("a thousand states got and freed grow memory by less than one state", &["test_a_thousand_states_leave_no_memory_behind"]),
    ("a panic answers Error; that instance waits for reset or a state, others go on", &["a_panic_ends_at_the_wall_and_reset_or_a_state_puts_things_right"]),
    ("results do not depend on threads, on logging, on who watches", &["threads_do_not_change_a_bit", "updates_come_after_internal_steps_and_watching_changes_no_bit", "every_way_to_run_a_channel_gives_the_same_bits_and_states_are_safe"]),
    ("exactly the standards' functions and `sandgate_*` are exported, with the headers' signatures", &["the_library_exports_what_the_headers_declare_and_nothing_else", "signatures_are_those_of_the_headers"]),
    ("arrays of FMI 3 have their elements as scalars beside them; a wrong number of values is refused", &["test_fmi_3_arrays_and_their_elements_agree"]),
    ("the descriptions are valid and complete: units, display units, types, InitialUnknowns, DefaultExperiment with four attributes", &["test_fmpy_finds_no_fault", "test_the_description_is_complete"]),
    ("the same scene and library give the same archive, byte for byte", &["packing_twice_gives_the_same_bytes"]),
    ("every case's FMUs pass FMPy's and FMU Manipulation Toolbox's checks, and FMI Library has no warning for them; ecos and libcosim get the bits of the C interface",
        &["every_case_s_fmus_pass_all_checks", "test_fmi_library_has_no_complaint_about_any_case", "test_ecos", "test_libcosim"]),
    ("a scene of several phases (a silted dam) is an FMU like any other: levels and discharge of each phase, states, logs, parameters",
        &["test_water_and_silt_flow_out_and_every_kilogram_is_accounted_for", "test_states_go_back_and_to_other_instances_with_the_same_bits", "test_its_log_runs_again_with_roll_backs", "test_levels_and_materials_are_parameters"]),
    ("a controller that moves the gate holds a depth within 5 %, and a master that does each step three times from saved states gets the same trajectory",
        &["test_the_depth_is_held_with_and_without_roll_back"]),
    ("an ensemble over parameters and inputs has the bits of a serial run on any number of workers, also when one is killed", &["test_a_killed_worker_changes_no_bit_and_costs_a_slice"]),
    ("the C interface leaves memory alone and nothing behind, under valgrind and the address sanitizer", &["a_client_in_c_leaves_its_memory_alone_and_nothing_behind"]),
    ("a library that used threads and a log is gone from memory when it is unloaded; a process that was forked goes on with threads of its own and the same bits",
        &["a_library_that_used_threads_and_a_log_can_be_unloaded", "a_forked_process_has_threads_of_its_own_and_the_same_bits"]),
];

/// Attributes of `CoSimulation` behind the model identifier.
pub(super) fn attributes(version: FmiVersion) -> Attributes {
    let claims = CAPABILITIES.iter().map(|c| {
        let name = match version {
            FmiVersion::V2 => c.fmi2,
            FmiVersion::V3 => c.fmi3,
        };
        (name, c.value)
    });
    claims
        .filter(|(name, value)| !name.is_empty() && *value != "false")
        .map(|(name, value)| (name, value.to_owned()))
        .collect()
}

/// Names of all tests that prove something.
pub fn proofs() -> impl Iterator<Item = &'static str> {
    let claims = CAPABILITIES.iter().flat_map(|c| c.proof);
    claims.chain(RULES.iter().flat_map(|r| r.1)).copied()
}

const HEAD: &str = include_str!("guide.md");

/// The text of docs/fmi.md.
#[must_use]
pub fn fmi_markdown() -> String {
    let mut text = HEAD.to_owned();
    text.push_str("\n## Capabilities\n\n| FMI 2.0 | FMI 3.0 | value | here | proved by |\n|---|---|---|---|---|\n");
    let name = |name: &str| {
        if name.is_empty() {
            "-".to_owned()
        } else {
            format!("`{name}`")
        }
    };
    for c in CAPABILITIES {
        // Writing to a String cannot fail.
        let _ = writeln!(
            text,
            "| {} | {} | {} | {} | {} |",
            name(c.fmi2),
            name(c.fmi3),
            c.value,
            c.meaning,
            tests(c.proof)
        );
    }
    text.push_str("\n## What importers can rely on\n\n| rule | proved by |\n|---|---|\n");
    for (rule, proof) in RULES {
        let _ = writeln!(text, "| {rule} | {} |", tests(proof));
    }
    text.push_str(
        "\n`test_*` are in tests/python; the others in tests/it, tests/contract (run for the component, FMI 2, FMI 3 \
         and C) and fmu/src.\n",
    );
    text
}

fn tests(names: &[&str]) -> String {
    let names: Vec<_> = names.iter().map(|name| format!("`{name}`")).collect();
    names.join(", ")
}
