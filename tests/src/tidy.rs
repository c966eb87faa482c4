//! The rules of the house, as checks on the sources.
//!
//! The checks read tokens, not text: what comments and strings say is free, and what macros
//! contain is seen.

use std::path::Path;

use proc_macro2::{Delimiter, Ident, Spacing, TokenStream, TokenTree};

/// The arrows inside `shared`: each module and those that it may use, besides itself.
pub const ARROWS: &[(&str, &[&str])] = &[
    ("units", &[]),
    ("time", &["units"]),
    ("limits", &["units", "time"]),
    ("motion", &["units", "time", "limits"]),
    ("wire", &["units", "time"]),
    (
        "parameter",
        &["units", "time", "limits", "motion", "wire", "drive"],
    ),
    ("drive", &["units", "time", "wire"]),
    (
        "axis",
        &[
            "units",
            "time",
            "limits",
            "motion",
            "parameter",
            "wire",
            "drive",
        ],
    ),
    (
        "node",
        &[
            "units",
            "time",
            "limits",
            "motion",
            "parameter",
            "wire",
            "drive",
            "axis",
        ],
    ),
];

/// The arrows between the crates: each package and those of this workspace that it may use.
pub const CRATES: &[(&str, &[&str])] = &[
    ("canter-shared", &[]),
    ("canter", &["canter-shared"]),
    ("canter-firmware", &["canter-shared"]),
    ("canter-images", &["canter-shared", "canter-firmware"]),
    (
        "canter-tests",
        &["canter", "canter-shared", "canter-images"],
    ),
];

/// The longest that a source file may be.
pub const MOST_LINES: usize = 600;

/// A rule that is broken: where, which, and what to do.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Finding {
    /// The file, from the root of the repository.
    pub file: String,
    /// The line, from 1.
    pub line: usize,
    /// The rule.
    pub rule: String,
    /// What to do.
    pub cure: &'static str,
}

impl std::fmt::Display for Finding {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self {
            file,
            line,
            rule,
            cure,
        } = self;
        write!(f, "{file}:{line}: {rule}; {cure}")
    }
}

/// A source file, read as tokens.
#[derive(Clone, Debug)]
pub struct Source {
    file: String,
    text: String,
    tokens: Vec<TokenTree>,
}

impl Source {
    /// Reads `text`, which `file` (a path from the root of the repository) holds.
    ///
    /// # Panics
    /// When it is not Rust.
    pub fn new(file: &str, text: &str) -> Self {
        let tokens = text.parse::<TokenStream>();
        let tokens = tokens.unwrap_or_else(|error| panic!("{file}: {error}"));
        let (file, text) = (file.to_owned(), text.to_owned());
        Self {
            file,
            text,
            tokens: tokens.into_iter().collect(),
        }
    }

    fn finding(&self, line: usize, rule: String, cure: &'static str) -> Finding {
        Finding {
            file: self.file.clone(),
            line,
            rule,
            cure,
        }
    }

    /// The module that a file in `src/` is: `shared/src/wire/id.rs` is `wire::id`, `lib.rs` is the
    /// crate itself.
    fn module(&self) -> Vec<String> {
        let path = self
            .file
            .split_once("src/")
            .map_or(&*self.file, |(_, path)| path);
        let path = path.strip_suffix(".rs").unwrap_or(path);
        let path = path.strip_suffix("/mod").unwrap_or(path);
        let names = path.split('/').map(str::to_owned);
        names.filter(|name| name != "lib").collect()
    }

    /// Whether the file is `motion` or part of it.
    pub fn is_motion(&self) -> bool {
        self.module().first().is_some_and(|name| name == "motion")
    }

    /// Whether the file is, or is part of, one of `modules`, which are paths without `.rs`.
    pub fn is_in(&self, modules: &[String]) -> bool {
        let path = self.file.strip_suffix(".rs").unwrap_or(&self.file);
        modules
            .iter()
            .any(|module| Path::new(path).starts_with(module))
    }

    /// A module of `shared` uses only those that [`ARROWS`] gives it.
    pub fn arrows(&self) -> Vec<Finding> {
        let module = self.module();
        let Some(own) = module.first() else {
            return Vec::new();
        };
        let Some((_, allowed)) = ARROWS.iter().find(|(name, _)| name == own) else {
            let rule = format!("the module `{own}` has no place in the order of the modules");
            return vec![self.finding(
                1,
                rule,
                "give it one in ARROWS and in docs/architecture.md",
            )];
        };
        let mut used = Vec::new();
        uses(&self.tokens, &module, &mut used);
        let mut findings = Vec::new();
        for (name, line) in used {
            if name == *own || allowed.contains(&&*name) {
                continue;
            }
            findings.push(if ARROWS.iter().any(|(known, _)| *known == name) {
                let rule = format!("`{own}` must not use `{name}`");
                self.finding(
                    line,
                    rule,
                    "move what is needed to the lower module, or pass it in",
                )
            } else {
                let rule =
                    format!("`{own}` uses `{name}` of the crate's root, which hides its module");
                self.finding(line, rule, "name the module that it comes from")
            });
        }
        findings
    }

    /// No token of this file is `name`.
    pub fn never_mentions(&self, name: &str) -> Vec<Finding> {
        let mut findings = Vec::new();
        each_ident(&self.tokens, &mut |ident| {
            if ident == name {
                let rule = format!("`{name}` must not appear here");
                let cure = "motion knows no bytes: translate in `axis`";
                findings.push(self.finding(ident.span().start().line, rule, cure));
            }
        });
        findings
    }

    /// Nothing here can panic by name, tests and what the compiler evaluates aside.
    pub fn no_panics(&self) -> Vec<Finding> {
        let mut findings = Vec::new();
        if !is_test_only(&self.tokens) {
            panics(&self.tokens, &mut |line, what| {
                let rule = format!("`{what}` can stop the device");
                findings.push(self.finding(
                    line,
                    rule,
                    "return an error, or make the case impossible",
                ));
            });
        }
        findings
    }

    /// The modules that this file declares for tests only, as paths without `.rs`.
    pub fn test_modules(&self) -> Vec<String> {
        let folder = match Path::new(&self.file) {
            file if file.ends_with("lib.rs") || file.ends_with("mod.rs") => file.parent(),
            _ => self.file.strip_suffix(".rs").map(Path::new),
        };
        let folder = folder.map_or_else(String::new, |folder| folder.display().to_string());
        let mut names = Vec::new();
        for at in 0..self.tokens.len() {
            if let Some(end) = test_item(&self.tokens, at) {
                let item = &self.tokens[at..end];
                if let [
                    ..,
                    TokenTree::Ident(word),
                    TokenTree::Ident(name),
                    TokenTree::Punct(end),
                ] = item
                    && word == "mod"
                    && end.as_char() == ';'
                {
                    names.push(format!("{folder}/{name}"));
                }
            }
        }
        names
    }

    /// The crate's root has the inner attribute `name`, or `name(argument)`.
    pub fn has_attribute(&self, name: &str, cure: &'static str) -> Vec<Finding> {
        let wanted: String = name.split_whitespace().collect();
        let found = self.tokens.windows(3).any(|tokens| match tokens {
            [
                TokenTree::Punct(hash),
                TokenTree::Punct(bang),
                TokenTree::Group(group),
            ] => {
                let text: String = group.stream().to_string().split_whitespace().collect();
                (hash.as_char(), bang.as_char()) == ('#', '!') && text == wanted
            }
            _ => false,
        });
        let rule = format!("`#![{name}]` is missing");
        if found {
            Vec::new()
        } else {
            vec![self.finding(1, rule, cure)]
        }
    }

    /// The file can be read in one sitting.
    pub fn short(&self) -> Vec<Finding> {
        let count = self.text.lines().count();
        let rule = format!("{count} lines, where {MOST_LINES} are the most");
        let long = count > MOST_LINES;
        if long {
            vec![self.finding(count, rule, "split it by what its parts do")]
        } else {
            Vec::new()
        }
    }
}

/// No path of somebody's machine is in `text`.
pub fn no_machine_paths(file: &str, text: &str) -> Vec<Finding> {
    // Written so that this file keeps its own rule.
    let machine = ["home", "work", "root", "Users"].map(|name| format!("/{name}/"));
    let mut findings = Vec::new();
    for (index, line) in text.lines().enumerate() {
        for path in &machine {
            // In the middle of a longer path (`docs/work/`, `~/work/`) it names no machine.
            let within = |c: char| c.is_alphanumeric() || "./~_-}".contains(c);
            let starts = line.match_indices(path.as_str());
            if starts
                .into_iter()
                .any(|(at, _)| !line[..at].ends_with(within))
            {
                let rule = format!("`{path}` is a path of one machine");
                let cure = "name it from the repository's root or from the environment";
                findings.push(Finding {
                    file: file.to_owned(),
                    line: index + 1,
                    rule,
                    cure,
                });
            }
        }
    }
    findings
}

/// The packages of a workspace use each other only as [`CRATES`] says, whether to build, to run or
/// to test; `metadata` is what `cargo metadata` prints.
pub fn crate_arrows(metadata: &serde_json::Value) -> Vec<Finding> {
    let packages = metadata["packages"]
        .as_array()
        .map_or(&[][..], Vec::as_slice);
    let text = |value: &serde_json::Value| value.as_str().unwrap_or_default().to_owned();
    let names: Vec<String> = packages
        .iter()
        .map(|package| text(&package["name"]))
        .collect();
    let mut findings = Vec::new();
    for (name, package) in names.iter().zip(packages) {
        let mut broken = |rule, cure| {
            let file = text(&package["manifest_path"]);
            findings.push(Finding {
                file,
                line: 1,
                rule,
                cure,
            });
        };
        let Some((_, allowed)) = CRATES.iter().find(|(known, _)| known == name) else {
            let rule = format!("the package `{name}` has no place in the order of the packages");
            broken(rule, "give it one in CRATES and in docs/architecture.md");
            continue;
        };
        for used in package["dependencies"].as_array().into_iter().flatten() {
            let used = text(&used["name"]);
            if names.contains(&used) && !allowed.contains(&&*used) {
                let rule = format!("`{name}` must not depend on `{used}`");
                broken(rule, "move what both need to `canter-shared`");
            }
        }
    }
    findings
}

/// The modules at the crate's root that `tokens`, part of `module`, name through a path; a glob of
/// the root, or its renaming, is `*`.
fn uses(tokens: &[TokenTree], module: &[String], used: &mut Vec<(String, usize)>) {
    let mut at = 0;
    while at < tokens.len() {
        match &tokens[at..] {
            [
                TokenTree::Ident(word),
                TokenTree::Ident(name),
                TokenTree::Group(body),
                ..,
            ] if word == "mod" && body.delimiter() == Delimiter::Brace => {
                let body: Vec<_> = body.stream().into_iter().collect();
                uses(&body, &[module, &[name.to_string()]].concat(), used);
                at += 3;
            }
            [TokenTree::Ident(word), rest @ ..]
                if ["crate", "super", "self", "canter_shared"]
                    .iter()
                    .any(|start| word == start) =>
            {
                let follows = leads_on(rest) || is_word(rest.first(), "as");
                at += if follows {
                    tree(&tokens[at..], module, used)
                } else {
                    1
                };
            }
            [TokenTree::Group(group), ..] => {
                let inner: Vec<_> = group.stream().into_iter().collect();
                uses(&inner, module, used);
                at += 1;
            }
            _ => at += 1,
        }
    }
}

/// Follows one path or tree of `use`, as far as it says which module it enters; gives the count of
/// tokens that it read.
fn tree(tokens: &[TokenTree], module: &[String], used: &mut Vec<(String, usize)>) -> usize {
    let mut base = module.to_vec();
    let mut at = 0;
    loop {
        let line = tokens.get(at).map_or(0, |token| token.span().start().line);
        let mut enter = |base: &[String], name: &str| {
            used.push((base.first().map_or(name, String::as_str).to_owned(), line));
        };
        match tokens.get(at) {
            Some(TokenTree::Ident(word)) => {
                match word.to_string().as_str() {
                    "crate" | "canter_shared" => base.clear(),
                    "super" => drop(base.pop()),
                    "self" => {}
                    name => {
                        enter(&base, name);
                        return at + 1;
                    }
                }
                at += 1;
                if leads_on(&tokens[at..]) {
                    at += 2;
                } else {
                    // The module itself, as in `use super as other`: at the root, all of it.
                    enter(&base, "*");
                    return at;
                }
            }
            Some(TokenTree::Group(group)) => {
                let inner: Vec<_> = group.stream().into_iter().collect();
                for branch in inner.split(|token| is_punct(Some(token), ',')) {
                    if !branch.is_empty() {
                        tree(branch, &base, used);
                    }
                }
                return at + 1;
            }
            Some(_) => {
                enter(&base, "*");
                return at + 1;
            }
            None => return at,
        }
    }
}

/// Calls `found` for each call by name that can panic.
fn panics(tokens: &[TokenTree], found: &mut impl FnMut(usize, &str)) {
    let mut at = 0;
    while at < tokens.len() {
        if let Some(end) = test_item(tokens, at).or_else(|| constant(tokens, at)) {
            at = end;
            continue;
        }
        if let TokenTree::Ident(ident) = &tokens[at] {
            let name = ident.to_string();
            let line = ident.span().start().line;
            let next_is_group = |next: usize| matches!(tokens.get(next), Some(TokenTree::Group(_)));
            let method = at > 0 && is_punct(tokens.get(at - 1), '.') && next_is_group(at + 1);
            let call = is_punct(tokens.get(at + 1), '!') && next_is_group(at + 2);
            match &*name {
                "unwrap" | "expect" if method => found(line, &format!(".{name}()")),
                "panic" | "unreachable" | "todo" | "unimplemented" if call => {
                    found(line, &format!("{name}!"));
                }
                _ => {}
            }
        }
        if let TokenTree::Group(group) = &tokens[at] {
            panics(&group.stream().into_iter().collect::<Vec<_>>(), found);
        }
        at += 1;
    }
}

/// Where the item that begins at `at` ends, if it is compiled for tests only.
fn test_item(tokens: &[TokenTree], at: usize) -> Option<usize> {
    let (TokenTree::Punct(hash), TokenTree::Group(attribute)) = (&tokens[at], tokens.get(at + 1)?)
    else {
        return None;
    };
    (hash.as_char() == '#' && is_test_condition(attribute.stream())).then_some(())?;
    // An item ends with its body or with a semicolon; the groups of further attributes, of
    // arguments and of types have other brackets.
    let ends = |token: &TokenTree| match token {
        TokenTree::Group(group) => group.delimiter() == Delimiter::Brace,
        other => is_punct(Some(other), ';'),
    };
    let end = tokens[at..].iter().position(ends);
    Some(end.map_or(tokens.len(), |end| at + end + 1))
}

/// Where the constant expression that begins at `at` ends: the compiler evaluates it, so that its
/// panic stops the build, not the device.
fn constant(tokens: &[TokenTree], at: usize) -> Option<usize> {
    is_word(tokens.get(at), "const").then_some(())?;
    match tokens.get(at + 1)? {
        TokenTree::Group(group) if group.delimiter() == Delimiter::Brace => Some(at + 2),
        // In `<const N: usize>` it is a parameter.
        TokenTree::Ident(_)
            if is_punct(tokens.get(at + 2), ':')
                && !(at > 0
                    && ['<', ',']
                        .iter()
                        .any(|&mark| is_punct(tokens.get(at - 1), mark))) =>
        {
            let length = tokens[at..]
                .iter()
                .position(|token| is_punct(Some(token), ';'))?;
            Some(at + length + 1)
        }
        _ => None,
    }
}

/// Whether the whole file is compiled for tests only: `#![cfg(test)]`.
fn is_test_only(tokens: &[TokenTree]) -> bool {
    tokens.windows(3).any(|tokens| match tokens {
        [hash, bang, TokenTree::Group(attribute)] => {
            is_punct(Some(hash), '#')
                && is_punct(Some(bang), '!')
                && is_test_condition(attribute.stream())
        }
        _ => false,
    })
}

fn is_test_condition(attribute: TokenStream) -> bool {
    let text: String = attribute.to_string().split_whitespace().collect();
    text == "cfg(test)" || text.starts_with("cfg(all(test,")
}

fn each_ident(tokens: &[TokenTree], visit: &mut impl FnMut(&Ident)) {
    for token in tokens {
        match token {
            TokenTree::Ident(ident) => visit(ident),
            TokenTree::Group(group) => {
                each_ident(&group.stream().into_iter().collect::<Vec<_>>(), visit)
            }
            _ => {}
        }
    }
}

/// Whether `::` comes next.
fn leads_on(tokens: &[TokenTree]) -> bool {
    match tokens {
        [TokenTree::Punct(one), TokenTree::Punct(two), ..] => {
            (one.as_char(), one.spacing(), two.as_char()) == (':', Spacing::Joint, ':')
        }
        _ => false,
    }
}

fn is_punct(token: Option<&TokenTree>, mark: char) -> bool {
    matches!(token, Some(TokenTree::Punct(punct)) if punct.as_char() == mark)
}

fn is_word(token: Option<&TokenTree>, word: &str) -> bool {
    matches!(token, Some(TokenTree::Ident(ident)) if ident == word)
}
