//! The program `sandgate`: hands over to [`sandgate::cli::main`] and returns its exit code; nothing else.

/// Gives freed memory back to the system: a served component runs for days (docs/zenoh.md, "Soak").
#[global_allocator]
static ALLOCATOR: tikv_jemallocator::Jemalloc = tikv_jemallocator::Jemalloc;

fn main() -> std::process::ExitCode {
    sandgate::cli::main()
}
