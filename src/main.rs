//! The program `sandgate`: hands over to [`sandgate::cli::main`] and returns its exit code; nothing else.

fn main() -> std::process::ExitCode {
    sandgate::cli::main()
}
