//! A real browser without a window, steered through the DevTools protocol on a pair of pipes.

use std::io::{BufRead, BufReader, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdin, Command, Stdio};
use std::sync::mpsc::{Receiver, channel};
use std::thread;

use serde_json::{Value, json};
use tempfile::TempDir;

use crate::PATIENCE;

/// What the browser is called, by distribution.
const NAMES: [&str; 4] = ["chromium", "chromium-browser", "google-chrome", "chrome"];

/// A browser with a profile of its own. Dropping it ends it.
#[derive(Debug)]
pub struct Browser {
    child: Child,
    to: ChildStdin,
    from: Receiver<Value>,
    calls: u64,
    /// What happened in the page and nobody has asked for yet.
    events: Vec<Value>,
    session: Option<String>,
    _profile: TempDir,
}

/// How a page is looked at.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct View {
    /// In CSS pixels.
    pub width: u32,
    /// In CSS pixels.
    pub height: u32,
    /// Whether the person prefers dark pages.
    pub dark: bool,
    /// Whether the person prefers less motion.
    pub still: bool,
    /// Whether the page's programs may run.
    pub scripts: bool,
}

impl Browser {
    /// Starts the browser, with a page of nothing.
    ///
    /// # Panics
    /// When there is none, or it does not answer.
    pub fn start() -> Self {
        let path = std::env::var_os("PATH").unwrap_or_default();
        let mut places =
            std::env::split_paths(&path).flat_map(|folder| NAMES.map(|name| folder.join(name)));
        let program: PathBuf = places
            .find(|place| place.is_file())
            .expect("there is no browser: install the package chromium");
        let profile = tempfile::tempdir().expect("a directory");
        // The browser reads commands from descriptor 3 and answers on 4, each ended by a zero byte.
        let mut child = Command::new("sh")
            .args(["-c", "exec \"$@\" 3<&0 4>&1 0</dev/null 1>&2", "sh"])
            .arg(program)
            .args([
                "--headless",
                "--no-sandbox",
                "--disable-gpu",
                "--disable-background-networking",
                "--disable-component-update",
                "--no-first-run",
                "--remote-debugging-pipe",
            ])
            .arg(format!("--user-data-dir={}", profile.path().display()))
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .expect("a shell starts");
        let to = child.stdin.take().expect("it is a pipe");
        let answers = child.stdout.take().expect("it is a pipe");
        let (sender, from) = channel();
        thread::spawn(move || {
            let messages = BufReader::new(answers).split(0).map_while(Result::ok);
            for message in messages.map_while(|bytes| serde_json::from_slice(&bytes).ok()) {
                if sender.send(message).is_err() {
                    break;
                }
            }
        });
        let mut browser = Self {
            child,
            to,
            from,
            calls: 0,
            events: Vec::new(),
            session: None,
            _profile: profile,
        };
        let page = browser.call("Target.createTarget", json!({"url": "about:blank"}));
        let attach = json!({"targetId": page["targetId"], "flatten": true});
        let session = browser.call("Target.attachToTarget", attach);
        browser.session = session["sessionId"].as_str().map(str::to_owned);
        for domain in ["Page", "Runtime", "Log", "Network"] {
            browser.call(&format!("{domain}.enable"), json!({}));
        }
        browser
    }

    /// Opens a file, and returns when it is loaded.
    ///
    /// # Panics
    /// When the browser does not do it.
    pub fn open(&mut self, file: &Path, view: View) {
        let View {
            width,
            height,
            dark,
            still,
            scripts,
        } = view;
        let size = json!({"width": width, "height": height, "deviceScaleFactor": 1, "mobile": width < 600});
        self.call("Emulation.setDeviceMetricsOverride", size);
        let scheme = if dark { "dark" } else { "light" };
        let motion = if still { "reduce" } else { "no-preference" };
        let features = json!({"features": [
            {"name": "prefers-color-scheme", "value": scheme},
            {"name": "prefers-reduced-motion", "value": motion},
        ]});
        self.call("Emulation.setEmulatedMedia", features);
        let disabled = json!({"value": !scripts});
        self.call("Emulation.setScriptExecutionDisabled", disabled);
        self.events.clear();
        let url = format!("file://{}", file.display());
        self.call("Page.navigate", json!({"url": url}));
        self.wait_for("Page.loadEventFired");
    }

    /// What an expression of JavaScript comes to in the page; promises are waited for.
    ///
    /// # Panics
    /// When it throws.
    #[track_caller]
    pub fn evaluate(&mut self, expression: &str) -> Value {
        let parameters = json!({
            "expression": expression,
            "returnByValue": true,
            "awaitPromise": true,
        });
        let answer = self.call("Runtime.evaluate", parameters);
        let thrown = &answer["exceptionDetails"];
        assert!(thrown.is_null(), "{expression}: {thrown}");
        answer["result"]["value"].clone()
    }

    /// What the page complained of since it was opened: exceptions, errors, warnings, and what its own
    /// policy forbade.
    pub fn complaints(&mut self) -> Vec<String> {
        // Whatever it has complained of has come before the answer.
        self.evaluate("0");
        let complaint = |event: &Value| {
            let what = &event["params"];
            match event["method"].as_str()? {
                "Runtime.exceptionThrown" => Some(what["exceptionDetails"].to_string()),
                "Runtime.consoleAPICalled" => Some(what["args"].to_string()),
                "Log.entryAdded" => Some(what["entry"]["text"].to_string()),
                _ => None,
            }
        };
        self.events.iter().filter_map(complaint).collect()
    }

    /// The addresses that were asked for since the page was opened, itself aside.
    pub fn requests(&mut self) -> Vec<String> {
        self.evaluate("0");
        let requests = self.events.iter().filter_map(|event| {
            let what = &event["params"];
            let is_request = event["method"] == "Network.requestWillBeSent";
            let is_page =
                what["type"] == "Document" && what["documentURL"] == what["request"]["url"];
            (is_request && !is_page).then(|| what["request"]["url"].to_string())
        });
        requests.collect()
    }

    /// Waits until an expression is true.
    ///
    /// # Panics
    /// When it is not after half of [`PATIENCE`]; the rest is for the answer.
    #[track_caller]
    pub fn wait_until(&mut self, expression: &str) {
        let frames = format!(
            "new Promise((done) => {{
                const end = performance.now() + {};
                const look = () => {{
                    if ({expression}) done(true);
                    else if (performance.now() > end) done(false);
                    else requestAnimationFrame(look);
                }};
                look();
            }})",
            (PATIENCE / 2).as_millis()
        );
        let came = self.evaluate(&frames);
        assert_eq!(came, Value::Bool(true), "{expression} has not come true");
    }

    fn wait_for(&mut self, event: &str) {
        while !self.events.iter().any(|seen| seen["method"] == event) {
            let next = self.next();
            self.events.push(next);
        }
    }

    fn next(&mut self) -> Value {
        self.from
            .recv_timeout(PATIENCE)
            .expect("the browser answers")
    }

    #[track_caller]
    fn call(&mut self, method: &str, parameters: Value) -> Value {
        self.calls += 1;
        let mut call = json!({"id": self.calls, "method": method, "params": parameters});
        if let Some(session) = &self.session {
            call["sessionId"] = session.as_str().into();
        }
        let mut message = call.to_string().into_bytes();
        message.push(0);
        self.to.write_all(&message).expect("the browser listens");
        loop {
            let answer = self.next();
            if answer["id"] == self.calls {
                assert!(answer["error"].is_null(), "{method}: {}", answer["error"]);
                return answer["result"].clone();
            }
            self.events.push(answer);
        }
    }
}

impl Drop for Browser {
    fn drop(&mut self) {
        // It takes all its processes along and leaves the profile alone, which goes next.
        let close = b"{\"id\":0,\"method\":\"Browser.close\"}\0";
        if self.to.write_all(close).is_err() {
            let _ = self.child.kill();
        }
        while self.from.recv_timeout(PATIENCE).is_ok() {}
        let _ = self.child.wait();
    }
}
