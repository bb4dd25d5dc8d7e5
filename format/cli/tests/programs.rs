//! Whole programs: how they end when they fail, when their reader goes away, and when they are interrupted.

use std::process::{Child, Command, ExitCode, Stdio};

/// Tells this binary to act as one of the programs instead of testing them.
const ROLE: &str = "OCTVOX_TEST_ROLE";

fn main() -> ExitCode {
    if let Ok(role) = std::env::var(ROLE) {
        return octvox_cli::run(|| act(&role));
    }
    a_failure_is_one_line();
    a_failure_without_standard_error_keeps_its_status();
    a_reader_that_goes_away_is_no_failure();
    #[cfg(unix)]
    an_interrupt_leaves_no_half_file();
    ExitCode::SUCCESS
}

fn act(role: &str) -> anyhow::Result<()> {
    match role {
        "fail" => anyhow::bail!("two\nlines"),
        "print" => {
            // More than a pipe holds.
            octvox_cli::print_line(&"text ".repeat(1 << 16))
        }
        "write" => octvox_cli::write_atomically("model.vox".as_ref(), |out| {
            use std::io::Write;
            out.write_all(b"half")?;
            out.flush()?;
            octvox_cli::print_line("begun")?;
            std::thread::sleep(std::time::Duration::from_secs(60));
            Ok(())
        }),
        _ => anyhow::bail!("no such role: {role}"),
    }
}

fn start(role: &str, folder: &std::path::Path) -> Child {
    Command::new(std::env::current_exe().unwrap())
        .env(ROLE, role)
        .current_dir(folder)
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap()
}

fn a_failure_is_one_line() {
    let output = start("fail", ".".as_ref()).wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(1));
    assert_eq!(output.stderr, b"error: two lines\n");
    assert!(output.stdout.is_empty());
}

fn a_failure_without_standard_error_keeps_its_status() {
    let mut child = start("fail", ".".as_ref());
    drop(child.stderr.take());
    assert_eq!(child.wait().unwrap().code(), Some(1));
}

fn a_reader_that_goes_away_is_no_failure() {
    let mut child = start("print", ".".as_ref());
    drop(child.stdout.take());
    let output = child.wait_with_output().unwrap();
    assert!(output.status.success() && output.stderr.is_empty(), "{output:?}");
}

#[cfg(unix)]
fn an_interrupt_leaves_no_half_file() {
    use std::io::{BufRead, BufReader};
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("model.vox"), "old").unwrap();
    let mut child = start("write", folder.path());
    let mut begun = String::new();
    BufReader::new(child.stdout.take().unwrap()).read_line(&mut begun).unwrap();
    assert_eq!(begun, "begun\n");
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 2);

    let sent = Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
    assert!(sent.success());
    assert_eq!(child.wait().unwrap().code(), Some(130));
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
    assert_eq!(std::fs::read_to_string(folder.path().join("model.vox")).unwrap(), "old");
}
