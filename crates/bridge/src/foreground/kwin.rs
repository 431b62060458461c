//! The program in front, by KWin: a script in it tells over D-Bus whose window has the keyboard.

use std::env;
use std::fs;
use std::path::PathBuf;
use std::process;
use std::sync::{Arc, Mutex, PoisonError};

use zbus::blocking::Connection;
use zbus::blocking::connection::Builder;
use zbus::zvariant::DynamicType;

use super::program::{Foreground, OwnProgram};

const KWIN: &str = "org.kde.KWin";
const SCRIPTING: (&str, &str) = ("/Scripting", "org.kde.kwin.Scripting");

/// Where the script tells what it sees, on this connection.
const LISTENER: &str = "/Foreground";

/// It is asked after so many looks whether the script is still there: KWin may have been started anew.
const LOOKS: u32 = 20;

/// The connection to KWin.
pub(super) struct Kwin {
    connection: Connection,
    script: String,
    /// The script's text, which KWin reads some time after it was told to start it.
    file: PathBuf,
    seen: Arc<Mutex<Seen>>,
    own: OwnProgram,
    looks: u32,
}

/// What the script told last.
#[derive(Default)]
struct Seen {
    classes: Vec<String>,
    process: Option<u32>,
}

/// What the script calls.
struct Listener(Arc<Mutex<Seen>>);

#[zbus::interface(name = "tactpad.Foreground")]
impl Listener {
    fn activated(&self, class: &str, name: &str, process: &str) {
        let classes = [name, class].into_iter().filter(|word| !word.is_empty()).map(str::to_owned).collect();
        *self.0.lock().unwrap_or_else(PoisonError::into_inner) =
            Seen { classes, process: process.parse().ok().filter(|process| *process > 0) };
    }
}

/// The script: Plasma 6 calls windows what Plasma 5 calls clients.
fn script(address: &str) -> String {
    format!(
        "function tell(it) {{\n\
         callDBus('{address}', '{LISTENER}', 'tactpad.Foreground', 'Activated', it ? String(it.resourceClass) : '', \
         it ? String(it.resourceName) : '', it ? String(it.pid) : '');\n\
         }}\n\
         (workspace.windowActivated || workspace.clientActivated).connect(tell);\n\
         tell(workspace.activeWindow || workspace.activeClient);\n"
    )
}

impl Kwin {
    /// Puts the script into the running KWin.
    ///
    /// # Errors
    /// There is none on the session's bus, or it takes no script.
    pub(super) fn open(own: OwnProgram) -> zbus::Result<Self> {
        let seen = Arc::<Mutex<Seen>>::default();
        let connection = Builder::session()?.serve_at(LISTENER, Listener(Arc::clone(&seen)))?.build()?;
        let script = format!("tactpad-{}", process::id());
        let folder = env::var_os("XDG_RUNTIME_DIR").map_or_else(env::temp_dir, PathBuf::from);
        let file = folder.join(format!("{script}.js"));
        let kwin = Self { connection, script, file, seen, own, looks: 0 };
        kwin.load()?;
        Ok(kwin)
    }

    fn load(&self) -> zbus::Result<()> {
        let address = self.connection.unique_name().map(|name| name.to_string()).unwrap_or_default();
        fs::write(&self.file, script(&address)).map_err(|error| zbus::Error::InputOutput(Arc::new(error)))?;
        self.scripting("loadScript", &(&*self.file.to_string_lossy(), &*self.script))?;
        self.scripting("start", &()).map(|_| ())
    }

    fn scripting(
        &self,
        method: &str,
        arguments: &(impl serde::Serialize + DynamicType),
    ) -> zbus::Result<zbus::Message> {
        let (path, interface) = SCRIPTING;
        self.connection.call_method(Some(KWIN), path, Some(interface), method, arguments)
    }

    /// Who has the keyboard now.
    ///
    /// # Errors
    /// KWin is gone, or the script.
    pub(super) fn front(&mut self) -> Result<Foreground, String> {
        self.looks += 1;
        if self.looks.is_multiple_of(LOOKS) {
            let answer = self.scripting("isScriptLoaded", &(&*self.script,));
            let is_there = answer.and_then(|answer| answer.body().deserialize::<bool>());
            if !is_there.map_err(|error| format!("KWin does not answer: {error}"))? {
                return Err("KWin was started anew".into());
            }
        }
        let seen = self.seen.lock().unwrap_or_else(PoisonError::into_inner);
        if seen.classes.is_empty() && seen.process.is_none() {
            return Ok(Foreground::Unknown);
        }
        Ok(self.own.or_program(seen.classes.clone(), seen.process))
    }
}

impl Drop for Kwin {
    fn drop(&mut self) {
        // One that stays calls nobody.
        let _ = self.scripting("unloadScript", &(&*self.script,));
        let _ = fs::remove_file(&self.file);
    }
}
