//! Files that Zenoh's configuration names: looked into before a session opens, since what Zenoh says of them has neither key nor path.

use crate::bus::error::BusError;
use std::fs::File;
use std::io::Read as _;
use zenoh::Config;

/// What a file has to hold.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Holds {
    Certificate,
    PrivateKey,
    Passwords,
}

/// Keys of the configuration that name a file.
const KEYS: [(&str, Holds); 6] = [
    ("transport/link/tls/root_ca_certificate", Holds::Certificate),
    ("transport/link/tls/listen_certificate", Holds::Certificate),
    ("transport/link/tls/listen_private_key", Holds::PrivateKey),
    ("transport/link/tls/connect_certificate", Holds::Certificate),
    ("transport/link/tls/connect_private_key", Holds::PrivateKey),
    ("transport/auth/usrpwd/dictionary_file", Holds::Passwords),
];

/// What whoever listens by TLS must have, under the first key or the second, which holds it itself.
const LISTENER: [(&str, &str); 2] = [
    (
        "transport/link/tls/listen_certificate",
        "transport/link/tls/listen_certificate_base64",
    ),
    (
        "transport/link/tls/listen_private_key",
        "transport/link/tls/listen_private_key_base64",
    ),
];

/// As much of a file as is looked at [bytes]: more than any list of passwords, of which a line must not be cut.
const LARGEST: u64 = 64 << 20;

/// Refuses files that cannot be read or hold something else, and listeners by TLS that have none.
pub(super) fn check(config: &Config, listen: &[String]) -> Result<(), BusError> {
    let said = |key: &str| -> Option<String> {
        let value = config.get_json(key).ok()?;
        serde_json::from_str::<Option<String>>(&value).ok()?
    };
    for (key, holds) in KEYS {
        if let Some(path) = said(key) {
            look_into(&path, holds).map_err(|reason| BusError::Config {
                file: format!("{key} = {path:?}"),
                reason,
            })?;
        }
    }
    // What follows # may name files of that endpoint alone.
    let by_tls = |e: &&String| e.starts_with("tls/") && !e.contains('#');
    let Some(endpoint) = listen.iter().find(by_tls) else {
        return Ok(());
    };
    for (file, text) in LISTENER {
        if said(file).is_none() && said(text).is_none() {
            return Err(BusError::Config {
                file: file.to_owned(),
                reason: format!("found nothing, needed to listen on {endpoint}; name a PEM file"),
            });
        }
    }
    Ok(())
}

fn look_into(path: &str, holds: Holds) -> Result<(), String> {
    let mut text = Vec::new();
    // A pipe that nobody writes to would be waited for.
    let is_file = std::fs::metadata(path).map(|found| found.is_file());
    let read = match is_file {
        Ok(false) => return Err("found a folder, device or pipe, allowed a file".to_owned()),
        Ok(true) => File::open(path).and_then(|file| file.take(LARGEST).read_to_end(&mut text)),
        Err(error) => Err(error),
    };
    read.map_err(|error| {
        let from = std::env::current_dir()
            .map_or_else(|_| String::new(), |here| here.display().to_string());
        format!("{error}; allowed a file that this process may read (it runs in {from})")
    })?;
    let text = String::from_utf8_lossy(&text);
    let has = |what: &str| text.contains("-----BEGIN ") && text.contains(what);
    let (certificate, key) = (has("CERTIFICATE-----"), has("PRIVATE KEY-----"));
    let found = match (certificate, key) {
        (true, _) => "a certificate",
        (_, true) => "a private key",
        _ => "no PEM text",
    };
    match holds {
        Holds::Certificate if !certificate => Err(format!(
            "found {found}, allowed a PEM file with a certificate (-----BEGIN CERTIFICATE-----)"
        )),
        Holds::PrivateKey if !key => Err(format!(
            "found {found}, allowed a PEM file with a private key (-----BEGIN PRIVATE KEY-----)"
        )),
        Holds::Passwords => check_passwords(&text),
        _ => Ok(()),
    }
}

/// One `name:password` a line, and at least one: with none Zenoh asks nobody for a password.
fn check_passwords(text: &str) -> Result<(), String> {
    let mut given = 0;
    for (line, entry) in (1..)
        .zip(text.lines())
        .filter(|(_, e)| !e.trim().is_empty())
    {
        let parts = entry.split_once(':');
        if parts.is_none_or(|(name, password)| name.trim().is_empty() || password.trim().is_empty())
        {
            // Not the line itself: it may be a password.
            return Err(format!(
                "line {line}: found no name and password, allowed name:password"
            ));
        }
        given += 1;
    }
    if given == 0 {
        return Err("found no line, allowed one name:password or more; without one everybody would be let in".to_owned());
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn refusal(config: &str, listen: &[&str]) -> String {
        let config = Config::from_json5(config).unwrap();
        let listen: Vec<String> = listen.iter().map(|&e| e.to_owned()).collect();
        check(&config, &listen).map_or_else(|error| error.to_string(), |()| String::new())
    }

    #[test]
    fn files_that_are_missing_or_hold_something_else_are_named_with_their_key() {
        let folder = temp_dir::TempDir::new().unwrap();
        let write = |name: &str, text: &str| {
            let path = folder.child(name);
            std::fs::write(&path, text).unwrap();
            path.display().to_string()
        };
        let certificate = write(
            "a.pem",
            "-----BEGIN CERTIFICATE-----\nMIIB\n-----END CERTIFICATE-----\n",
        );
        let key = write(
            "key.pem",
            "-----BEGIN EC PRIVATE KEY-----\nMIIB\n-----END EC PRIVATE KEY-----\n",
        );
        let empty = write("empty", "");
        let users = write("users", "plc:secret\n\nwatcher:other\n");
        let tls = |certificate: &str, key: &str| {
            format!(
                "{{transport: {{link: {{tls: {{listen_certificate: {certificate:?}, listen_private_key: {key:?}}}}}}}}}"
            )
        };
        assert_eq!(refusal(&tls(&certificate, &key), &["tls/127.0.0.1:0"]), "");
        for (certificate, key, told) in [
            (
                "/no/such.pem",
                key.as_str(),
                ["listen_certificate = \"/no/such.pem\"", "No such file"],
            ),
            (
                &key,
                &key,
                [
                    "listen_certificate",
                    "found a private key, allowed a PEM file with a certificate",
                ],
            ),
            (
                &certificate,
                &certificate,
                ["listen_private_key", "found a certificate"],
            ),
            (
                &certificate,
                &empty,
                ["listen_private_key", "found no PEM text"],
            ),
            (
                &folder.path().display().to_string(),
                &key,
                ["listen_certificate", "found a folder"],
            ),
        ] {
            let refusal = refusal(&tls(certificate, key), &[]);
            for told in told {
                assert!(refusal.contains(told), "{refusal}");
            }
        }
        let passwords = |file: &str| {
            format!("{{transport: {{auth: {{usrpwd: {{dictionary_file: {file:?}}}}}}}}}")
        };
        assert_eq!(refusal(&passwords(&users), &[]), "");
        let bad = write("bad", "plc:secret\nonly-a-secret\n");
        let refused = refusal(&passwords(&bad), &[]);
        assert!(
            refused.contains("line 2: found no name") && !refused.contains("only-a"),
            "{refused}"
        );
        let refused = refusal(&passwords(&empty), &[]);
        assert!(refused.contains("everybody would be let in"), "{refused}");
    }

    #[test]
    fn who_listens_by_tls_needs_a_certificate_and_its_key() {
        let refused = refusal("{}", &["tcp/127.0.0.1:0", "tls/127.0.0.1:7447"]);
        assert!(
            refused.contains("listen_certificate") && refused.contains("tls/127.0.0.1:7447"),
            "{refused}"
        );
        assert_eq!(refusal("{}", &["tcp/127.0.0.1:0"]), "");
        let half = "{transport: {link: {tls: {listen_certificate_base64: \"TUlJQg==\"}}}}";
        assert!(refusal(half, &["tls/[::1]:0"]).contains("listen_private_key: found nothing"));
    }
}
