//! The shared library as C sees it: names, signatures, the header, and a client in C.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;
use std::fs;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::OnceLock;

use crate::python::{program, root, run, target};

const COMPILER: &str =
    "these tests need a C and a C++ compiler as `cc` and `c++` (Debian: gcc, g++)";

/// The shared library, built once for all tests.
pub(crate) fn library() -> &'static Path {
    static LIBRARY: OnceLock<PathBuf> = OnceLock::new();
    LIBRARY.get_or_init(|| {
        sandgate::fmi::library::build(root(), &target()).expect("the shared library builds")
    })
}

/// Scratch folder of one test.
pub(crate) fn scratch(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).expect("the scratch folder is writable");
    folder
}

/// The official FMI headers, which the FMPy package carries.
fn fmi_headers() -> PathBuf {
    let output = run(
        "python -c 'import fmpy'",
        Command::new(program("python")).args(["-c", "import fmpy; print(fmpy.__path__[0])"]),
        "the environment has FMPy",
    );
    Path::new(String::from_utf8_lossy(&output.stdout).trim()).join("c-code")
}

/// Functions that the headers declare: co-simulation of FMI 2, all of FMI 3, and ours.
pub(crate) fn declared() -> BTreeSet<String> {
    let model_exchange = [
        "fmi2EnterEventMode",
        "fmi2NewDiscreteStates",
        "fmi2EnterContinuousTimeMode",
        "fmi2CompletedIntegratorStep",
        "fmi2SetTime",
        "fmi2SetContinuousStates",
        "fmi2GetDerivatives",
        "fmi2GetEventIndicators",
        "fmi2GetContinuousStates",
        "fmi2GetNominalsOfContinuousStates",
    ];
    let mut names = BTreeSet::new();
    for header in ["fmi2Functions.h", "fmi3Functions.h"] {
        let text = fs::read_to_string(fmi_headers().join(header)).expect("FMPy has the headers");
        // "FMI3_Export fmi3DoStepTYPE fmi3DoStep;"
        for line in text.lines().filter(|line| line.contains("_Export fmi")) {
            let name = line.split_whitespace().last().unwrap_or_default();
            names.insert(name.trim_end_matches(';').to_owned());
        }
    }
    for name in model_exchange {
        assert!(names.remove(name), "{name} is in fmi2Functions.h");
    }
    let ours = fs::read_to_string(root().join("include/sandgate.h")).expect("the header is there");
    for line in ours
        .lines()
        .filter(|line| !line.starts_with([' ', '*', '/']))
    {
        let Some((before, _)) = line.split_once('(') else {
            continue;
        };
        let name = before.rsplit([' ', '*']).next().unwrap_or_default();
        if name.starts_with("sandgate_") {
            names.insert(name.to_owned());
        }
    }
    names
}

#[test]
fn the_library_exports_what_the_headers_declare_and_nothing_else() {
    let output = run(
        "nm",
        Command::new("nm")
            .args(["-D", "--defined-only"])
            .arg(library()),
        "these tests need `nm` (Debian: binutils, comes with gcc)",
    );
    let text = String::from_utf8_lossy(&output.stdout);
    let exported: BTreeSet<String> = text
        .lines()
        .filter_map(|line| line.split_whitespace().last())
        .map(str::to_owned)
        .collect();
    assert_eq!(exported, declared());
    let count = |prefix: &str| exported.iter().filter(|n| n.starts_with(prefix)).count();
    assert_eq!((count("fmi2"), count("fmi3")), (34, 75));
}

#[test]
fn the_list_of_exports_is_not_stale() {
    let path = root().join("fmu/exports.def");
    let found = fs::read_to_string(&path).expect("it is there");
    let (head, _) = found.split_once("EXPORTS\n").expect("it is a list");
    let mut written = format!("{head}EXPORTS\n");
    for name in declared() {
        let _ = writeln!(written, "    {name}");
    }
    if std::env::var_os("SANDGATE_REGENERATE").is_some() {
        fs::write(&path, &written).expect("the source tree is writable");
    } else {
        assert_eq!(
            found, written,
            "run SANDGATE_REGENERATE=1 cargo test --release --test it exports"
        );
    }
}

#[test]
fn signatures_are_those_of_the_headers() {
    let mut rust = BTreeMap::new();
    for file in [
        "fmi2.rs",
        "fmi2/state.rs",
        "fmi2/variables.rs",
        "fmi3.rs",
        "fmi3/absent.rs",
        "fmi3/state.rs",
        "fmi3/variables.rs",
        "capi.rs",
        "capi/state.rs",
        "capi/variables.rs",
    ] {
        let source = fs::read_to_string(root().join("fmu/src").join(file)).expect("it is there");
        signatures(&source, &mut rust);
    }
    let folder = scratch("signatures");
    let mut source = String::from(
        "#include \"fmi2Functions.h\"\n#include \"fmi3Functions.h\"\n#include \"sandgate.h\"\n\
         #include \"signatures.hpp\"\nint main() {\n",
    );
    for name in declared() {
        let _ = writeln!(source, "    print(\"{name}\", {name});");
    }
    source.push_str("}\n");
    let file = folder.join("signatures.cpp");
    fs::write(&file, source).expect("the scratch folder is writable");
    let program = folder.join("signatures");
    run(
        "compiling the headers",
        Command::new("c++")
            .args(["-std=c++17", "-Wall", "-Wextra", "-Werror", "-o"])
            .args([&program, &file])
            .arg("-I")
            .arg(fmi_headers())
            .arg("-I")
            .arg(root().join("include"))
            .arg("-I")
            .arg(root().join("tests/c"))
            .args(link()),
        COMPILER,
    );
    let output = run(
        "signatures",
        &mut Command::new(&program),
        "it was just made",
    );
    let text = String::from_utf8_lossy(&output.stdout);
    let c: BTreeMap<String, String> = text
        .lines()
        .filter_map(|line| line.split_once('('))
        .map(|(name, rest)| (name.to_owned(), format!("({rest}")))
        .collect();
    assert!(c.len() > 109 + 20, "{} functions", c.len());
    for (name, signature) in &c {
        assert_eq!(rust.get(name), Some(signature), "{name}");
    }
    assert_eq!(rust.len(), c.len());
}

/// Signatures of exported functions in Rust source, spelled as tests/c/signatures.hpp does.
fn signatures(source: &str, into: &mut BTreeMap<String, String>) {
    for part in source.split("extern \"C\" fn ").skip(1) {
        let (name, rest) = part.split_once('(').expect("a function has arguments");
        if name.starts_with('$') {
            continue;
        }
        let (arguments, rest) = rest.split_once(')').expect("they end");
        let result = rest.split('{').next().unwrap_or_default();
        let result = result
            .trim()
            .strip_prefix("->")
            .map_or("v".to_owned(), spell);
        let types = split(arguments).map(|argument| {
            let (_, kind) = argument.split_once(':').expect("an argument has a type");
            spell(kind)
        });
        let types: Vec<_> = types.collect();
        into.insert(name.to_owned(), format!("({})->{result}", types.join(",")));
    }
    let entries = |name: &str| -> Vec<String> {
        let Some((_, block)) = source.split_once(&format!("\n{name}! {{")) else {
            return Vec::new();
        };
        let block = block.split("\n}").next().unwrap_or_default();
        let entries = block.split(';').map(str::trim).filter(|e| !e.is_empty());
        entries.map(str::to_owned).collect()
    };
    for entry in entries("no_variables") {
        let mut parts = entry.split(',');
        let (name, values) = (
            parts.next().unwrap_or_default(),
            parts.next().unwrap_or_default(),
        );
        let signature = format!("(p(o),pc(i4),i8,{},i8)->i4", spell(values));
        into.insert(name.to_owned(), signature);
    }
    for entry in entries("not_provided") {
        let (_, call) = entry
            .split_once("\": ")
            .expect("a capability and a function");
        let (name, types) = call.split_once('(').expect("a function has arguments");
        let mut all = vec!["p(o)".to_owned()];
        all.extend(split(types.trim_end_matches(')')).map(spell));
        into.insert(name.to_owned(), format!("({})->i4", all.join(",")));
    }
}

fn split(list: &str) -> impl Iterator<Item = &str> {
    list.split(',')
        .map(str::trim)
        .filter(|entry| !entry.is_empty())
}

fn spell(kind: &str) -> String {
    let kind = kind.trim();
    let inner = |kind: &str| match spell(kind.trim_end_matches('>')).as_str() {
        "o" => None,
        other => Some(other.to_owned()),
    };
    if let Some(inside) = kind.strip_prefix("In<") {
        return inner(inside).map_or("p(o)".to_owned(), |i| format!("pc({i})"));
    }
    if let Some(inside) = kind.strip_prefix("Out<") {
        return inner(inside).map_or("p(o)".to_owned(), |i| format!("p({i})"));
    }
    let spelled = match kind {
        "Handle"
        | "StateHandle"
        | "Environment"
        | "Logger3"
        | "PlainLogger"
        | "IntermediateUpdate3"
        | "UnusedCallback" => "p(o)",
        "StateSlot" => "p(p(o))",
        "Text" | "*const c_char" | "*const u8" => "pc(i1)",
        "Callbacks2" | "CVariable" | "CStepReport" | "CLedger" => "o",
        "i8" | "u8" => "i1",
        "i16" | "u16" => "i2",
        "i32" | "u32" | "Status" => "i4",
        "i64" | "u64" | "usize" => "i8",
        "f32" => "f4",
        "f64" => "f8",
        other => panic!("a type this test does not know: {other}"),
    };
    spelled.to_owned()
}

/// Arguments that link with the library and find it when the program runs.
pub(crate) fn link() -> Vec<String> {
    let folder = library().parent().expect("a file is in a folder").display();
    vec![
        format!("-L{folder}"),
        format!("-Wl,-rpath,{folder}"),
        "-lsandgate_fmu".to_owned(),
        "-lm".to_owned(),
    ]
}

#[test]
fn the_header_is_clean_c99_and_cpp17() {
    let folder = scratch("header");
    for (compiler, standard, file) in [("cc", "c99", "header.c"), ("c++", "c++17", "header.cpp")] {
        let file = folder.join(file);
        fs::write(
            &file,
            "#include \"sandgate.h\"\n#include \"sandgate.h\"\nint main(void) { return 0; }\n",
        )
        .expect("the scratch folder is writable");
        run(
            standard,
            Command::new(compiler)
                .arg(format!("-std={standard}"))
                .args(["-Wall", "-Wextra", "-Wpedantic", "-Werror"])
                .args(if compiler == "cc" {
                    &["-Wmissing-prototypes", "-Wstrict-prototypes"][..]
                } else {
                    &[]
                })
                .args(["-fsyntax-only", "-I"])
                .arg(root().join("include"))
                .arg(&file),
            COMPILER,
        );
    }
}

#[test]
fn the_cost_of_the_interface_can_be_measured() {
    let link = link();
    let link: Vec<&str> = link.iter().map(String::as_str).collect();
    let program = compiled("tests/c/cost.c", &scratch("cost"), &link);
    let output = run(
        "tests/c/cost.c",
        Command::new(&program).args([silo(), silo()]).arg("1"),
        "the program says what went wrong",
    );
    let text = String::from_utf8_lossy(&output.stdout);
    for part in [
        "all gauges by one call",
        "a step of a sleeping scene",
        "save",
    ] {
        assert!(text.contains(part), "{text}");
    }
}

/// Compiles a C99 program against the header, clean of warnings; gives the program.
pub(crate) fn compiled(source: &str, folder: &Path, options: &[&str]) -> PathBuf {
    let program = folder.join("program");
    run(
        &format!("compiling {source}"),
        Command::new("cc")
            .args(["-std=c99", "-g", "-Wall", "-Wextra", "-pedantic", "-Werror"])
            .arg("-o")
            .arg(&program)
            .arg(root().join(source))
            .arg("-I")
            .arg(root().join("include"))
            .args(options),
        COMPILER,
    );
    program
}

pub(crate) fn silo() -> PathBuf {
    root().join("tests/scenes/small_silo.toml")
}

#[test]
fn a_client_in_c_steps_saves_and_goes_on_with_the_same_bits() {
    let link = link();
    let link: Vec<&str> = link.iter().map(String::as_str).collect();
    let program = compiled("tests/c/client.c", &scratch("client"), &link);
    run(
        "tests/c/client.c",
        Command::new(&program).arg(silo()),
        "the client says what went wrong",
    );
}

/// The library with a scene inside, as an FMU of FMI 3 has it, and what `tests/c/environment.c` is told: token and references.
fn packed(folder: &Path) -> (Vec<String>, [String; 4]) {
    let scene = sandgate::scene::load(&silo()).expect("it loads");
    // As importers have it: from the description of a component of the scene as it was packed.
    let scene =
        sandgate::scene::parse("resources/scene.toml", &scene.source).expect("it is a scene");
    let component = sandgate::component::Component::new(&scene).expect("it builds");
    let mut bytes = fs::read(library()).expect("it was built");
    sandgate::fmi::slot::fill(&mut bytes, &scene.source).expect("it fits");
    fs::write(folder.join("libpacked.so"), bytes).expect("the scratch folder is writable");
    let folder = folder.display();
    let link = vec![
        format!("-L{folder}"),
        format!("-Wl,-rpath,{folder}"),
        "-lpacked".to_owned(),
        "-lm".to_owned(),
        "-lpthread".to_owned(),
        format!("-I{}", fmi_headers().display()),
    ];
    let names = [
        "solver.threads",
        "solver.resolution_scale",
        "gate.main.opening",
    ];
    let [threads, resolution, opening] = names.map(|name| {
        let row = component.variables().by_name(name).expect("it is there");
        row.reference.to_string()
    });
    let token = sandgate::fmi::token(&component, sandgate::fmi::FmiVersion::V3);
    (link, [token, threads, resolution, opening])
}

#[test]
fn an_importer_keeps_its_floating_point_environment_and_gets_the_same_bits() {
    let folder = scratch("environment");
    let (link, told) = packed(&folder);
    let link: Vec<&str> = link.iter().map(String::as_str).collect();
    let program = compiled("tests/c/environment.c", &folder, &link);
    run(
        "tests/c/environment.c",
        Command::new(&program).args(told),
        "it says what went wrong; a signal is a trap that was sprung inside the library",
    );
}

#[test]
fn a_client_in_c_leaves_its_memory_alone_and_nothing_behind() {
    let link = link();
    let mut options: Vec<&str> = link.iter().map(String::as_str).collect();
    options.push("-fsanitize=address,undefined");
    options.push("-fno-sanitize-recover=all");
    let program = compiled("tests/c/client.c", &scratch("client_asan"), &options);
    // Leaks are valgrind's part: LeakSanitizer asks for rights that containers often withhold.
    run(
        "tests/c/client.c under address and undefined behaviour sanitizers",
        Command::new(&program)
            .arg(silo())
            .env("ASAN_OPTIONS", "detect_leaks=0"),
        "the sanitizer says what was touched",
    );
    if Command::new("valgrind").arg("--version").output().is_err() {
        // Straight to the terminal: what a passed test prints is not shown.
        let _ = writeln!(
            std::io::stderr(),
            "\nNOT RUN: the C client under valgrind, which is not installed (Debian: apt-get install valgrind)\n"
        );
        return;
    }
    let program = compiled(
        "tests/c/client.c",
        &scratch("client_valgrind"),
        &options[..link.len()],
    );
    run(
        "tests/c/client.c under valgrind",
        Command::new("valgrind")
            .args(["--quiet", "--error-exitcode=9", "--leak-check=full"])
            // Not "possible": crossbeam's epochs keep their list behind pointers with marks in their low bits, which
            // valgrind does not take for pointers.
            .args(["--show-leak-kinds=definite,indirect"])
            .args(["--errors-for-leak-kinds=definite,indirect"])
            .arg(&program)
            .arg(silo())
            .arg("1"),
        "valgrind says what was touched or left behind",
    );
}

#[test]
fn the_example_in_c_runs_with_the_shared_and_with_the_static_library() {
    let link = link();
    let shared: Vec<&str> = link.iter().map(String::as_str).collect();
    let archive = library().with_extension("a").display().to_string();
    let alone = [archive.as_str(), "-lpthread", "-ldl", "-lm"];
    for (name, options) in [("shared", &shared[..]), ("static", &alone[..])] {
        let program = compiled("examples/c/silo.c", &scratch(name), options);
        let output = run(
            "examples/c/silo.c",
            Command::new(&program).arg(silo()),
            "it says what went wrong",
        );
        let said = String::from_utf8_lossy(&output.stdout).into_owned();
        assert!(said.contains("gauge.level.depth"), "{said}");
        assert!(said.contains("logStatusError: sandgate_step:"), "{said}");
    }
}

#[test]
fn the_example_in_python_runs_without_packages() {
    let output = run(
        "examples/ctypes_silo.py",
        // -I -S: no environment, no packages.
        Command::new("python3")
            .args(["-I", "-S"])
            .arg(root().join("examples/ctypes_silo.py"))
            .arg(library())
            .arg(silo()),
        "it says what went wrong",
    );
    let said = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(
        said.contains("refused: sandgate_set: set: gate.main.opening: found 1.5"),
        "{said}"
    );
    assert!(said.contains("the last: ('logStatusError'"), "{said}");
}

#[test]
fn the_manual_has_every_function_and_no_other() {
    let manual = fs::read_to_string(root().join("docs/c.md")).expect("the manual is there");
    let described: BTreeSet<String> = manual
        .lines()
        .filter_map(|line| line.strip_prefix("### `")?.strip_suffix('`'))
        .map(str::to_owned)
        .collect();
    let ours = declared()
        .into_iter()
        .filter(|n| n.starts_with("sandgate_"));
    assert_eq!(described, ours.collect());
    // Each with its declaration, word for word but for line breaks.
    let words = |text: &str| text.split_whitespace().collect::<Vec<_>>().join(" ");
    let (manual, header) = (
        words(&manual),
        fs::read_to_string(root().join("include/sandgate.h")),
    );
    let header = words(&header.expect("the header is there"));
    for name in described {
        let at = header
            .find(&format!(" {name}("))
            .or_else(|| header.find(&format!("*{name}(")));
        let rest = &header[at.expect("declared") + 1..];
        let declaration = rest.split_inclusive(';').next().unwrap_or_default();
        assert!(manual.contains(declaration), "docs/c.md: {declaration}");
    }
}
