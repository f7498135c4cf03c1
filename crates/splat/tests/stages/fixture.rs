//! The format of stage fixtures: `docs/design/012-stage-fixtures.md`.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::PathBuf;

use serde_json::{Map, Value, json};

/// Arrays by name.
pub type Arrays = BTreeMap<&'static str, Vec<f32>>;

/// A stage with the answers to some inputs.
#[derive(Debug)]
pub struct Fixture {
    pub stage: &'static str,
    /// Inputs and answers, with units and the order of the axes.
    pub what: &'static str,
    /// Source of the answers.
    pub made_from: &'static str,
    /// Tolerance of other backends: relative to the answer, and absolute.
    pub tolerance: [f64; 2],
    /// Names of the answers that are whole numbers, which must be met exactly.
    pub exact: &'static [&'static str],
    pub cases: Vec<Case>,
}

/// One input with its answer.
#[derive(Debug, Default)]
pub struct Case {
    pub name: String,
    inputs: Map<String, Value>,
    pub outputs: BTreeMap<String, Vec<f32>>,
}

impl Case {
    pub fn new(name: impl Into<String>) -> Self {
        Self { name: name.into(), ..Self::default() }
    }

    /// Adds a text.
    pub fn with_text(mut self, name: &str, text: &str) -> Self {
        self.inputs.insert(name.to_owned(), json!(text));
        self
    }

    /// Adds a number.
    pub fn with(mut self, name: &str, number: f64) -> Self {
        self.inputs.insert(name.to_owned(), number_of(number));
        self
    }

    /// Adds an array, rounded to f32; formulas must get the rounded numbers, from [`Case::numbers`].
    pub fn with_array(mut self, name: &str, numbers: impl IntoIterator<Item = f64>) -> Self {
        let numbers: Vec<Value> = numbers.into_iter().map(number_of).collect();
        self.inputs.insert(name.to_owned(), Value::Array(numbers));
        self
    }

    /// Adds an answer.
    pub fn answer(mut self, name: &str, numbers: impl IntoIterator<Item = f64>) -> Self {
        self.outputs.insert(name.to_owned(), numbers.into_iter().map(|x| x as f32).collect());
        self
    }

    pub fn text(&self, name: &str) -> &str {
        self.inputs[name].as_str().unwrap_or_else(|| panic!("{name} of {} is a text", self.name))
    }

    pub fn number(&self, name: &str) -> f64 {
        self.inputs[name].as_f64().unwrap_or_else(|| panic!("{name} of {} is a number", self.name))
    }

    pub fn count(&self, name: &str) -> usize {
        self.number(name) as usize
    }

    pub fn numbers(&self, name: &str) -> Vec<f64> {
        let array = self.inputs[name].as_array().unwrap_or_else(|| panic!("{name} of {} is an array", self.name));
        array.iter().map(|x| x.as_f64().expect("a number")).collect()
    }

    pub fn floats(&self, name: &str) -> Vec<f32> {
        self.numbers(name).into_iter().map(|x| x as f32).collect()
    }

    pub fn array<const N: usize>(&self, name: &str) -> [f64; N] {
        self.numbers(name).try_into().unwrap_or_else(|_| panic!("{name} of {} has {N} numbers", self.name))
    }
}

/// The shortest decimal that is the f32 nearest to a number; NaN is `null`.
fn number_of(x: f64) -> Value {
    let text = (x as f32).to_string();
    match text.parse::<i64>() {
        Ok(whole) => json!(whole),
        Err(_) => json!(text.parse::<f64>().ok().filter(|x| x.is_finite())),
    }
}

fn folder() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("fixtures")
}

impl Fixture {
    fn path(&self) -> PathBuf {
        folder().join(format!("{}.json", self.stage))
    }

    /// Writes the file, an array per line, so that a change shows where it is.
    pub fn write(&self) {
        let mut text = String::from("{\n");
        let mut line = |key: &str, value: &Value| writeln!(text, "\"{key}\": {value},").expect("a line");
        line("stage", &json!(self.stage));
        line("what", &json!(self.what));
        line("made_from", &json!(self.made_from));
        line("tolerance", &json!({ "relative": self.tolerance[0], "absolute": self.tolerance[1] }));
        line("exact", &json!(self.exact));
        let lines = |map: &mut dyn Iterator<Item = (&String, Value)>| {
            map.map(|(key, value)| format!("    \"{key}\": {value}")).collect::<Vec<_>>().join(",\n")
        };
        let of = |case: &Case| {
            let inputs = lines(&mut case.inputs.iter().map(|(key, value)| (key, value.clone())));
            let array = |numbers: &Vec<f32>| Value::Array(numbers.iter().map(|x| number_of(f64::from(*x))).collect());
            let outputs = lines(&mut case.outputs.iter().map(|(key, numbers)| (key, array(numbers))));
            let name = json!(case.name);
            format!("  {{\"name\": {name},\n   \"in\": {{\n{inputs}\n   }},\n   \"out\": {{\n{outputs}\n   }}}}")
        };
        let cases: Vec<String> = self.cases.iter().map(of).collect();
        write!(text, "\"cases\": [\n{}\n]\n}}\n", cases.join(",\n")).expect("a line");
        std::fs::write(self.path(), text).expect("the folder of fixtures can be written to");
    }

    /// The cases of the stage's file.
    pub fn stored(&self) -> Vec<Case> {
        let text = std::fs::read_to_string(self.path())
            .unwrap_or_else(|error| panic!("{}: {error}; make fixtures", self.path().display()));
        let file: Value = serde_json::from_str(&text).expect("a fixture is JSON");
        assert_eq!(file["stage"], self.stage);
        let case = |case: &Value| {
            let outputs = case["out"].as_object().expect("out").iter().map(|(name, numbers)| {
                let numbers = numbers.as_array().expect("an array").iter();
                (name.clone(), numbers.map(|x| x.as_f64().map_or(f32::NAN, |x| x as f32)).collect())
            });
            Case {
                name: case["name"].as_str().expect("a name").to_owned(),
                inputs: case["in"].as_object().expect("in").clone(),
                outputs: outputs.collect(),
            }
        };
        file["cases"].as_array().expect("cases").iter().map(case).collect()
    }

    /// Compares arrays with the answers of a case; the error says where they are off.
    pub fn check(&self, case: &Case, got: &Arrays, by: &str) -> Result<(), String> {
        let at = format!("{} of {}, {by}", case.name, self.stage);
        let names = |names: &mut dyn Iterator<Item = &str>| names.map(str::to_owned).collect::<Vec<_>>();
        let (has, wants) = (names(&mut got.keys().copied()), names(&mut case.outputs.keys().map(String::as_str)));
        if has != wants {
            return Err(format!("{at}: gives {has:?}, not {wants:?}"));
        }
        for (name, want) in &case.outputs {
            let got = &got[name.as_str()];
            if got.len() != want.len() {
                return Err(format!("{at}: {name} has {} numbers, not {}", got.len(), want.len()));
            }
            let [relative, absolute] = if self.exact.contains(&name.as_str()) { [0.0; 2] } else { self.tolerance };
            let is_near = |(got, want): (&f32, &f32)| {
                let (got, want) = (f64::from(*got), f64::from(*want));
                (got - want).abs() <= absolute + relative * want.abs() || (got.is_nan() && want.is_nan())
            };
            if let Some(i) = got.iter().zip(want).position(|pair| !is_near(pair)) {
                return Err(format!("{at}: {name}[{i}] is {}, not {}", got[i], want[i]));
            }
        }
        Ok(())
    }

    /// Compares the stored cases with those that the formulas give now.
    pub fn check_stored(&self) {
        let stored = self.stored();
        assert_eq!(stored.len(), self.cases.len(), "{}", self.stage);
        for (stored, case) in stored.iter().zip(&self.cases) {
            assert_eq!((&stored.name, &stored.inputs), (&case.name, &case.inputs), "{}; make fixtures", self.stage);
            // Other processors' libraries have other last bits in f64.
            let near = |(a, b): (&f32, &f32)| (a - b).abs() <= 1e-6 * b.abs() + 1e-7 || (a.is_nan() && b.is_nan());
            for (name, numbers) in &case.outputs {
                let same = stored.outputs.get(name).is_some_and(|stored| stored.iter().zip(numbers).all(near));
                assert!(same, "{name} of {} of {}; make fixtures", case.name, self.stage);
            }
        }
    }
}

/// Size of all files, in bytes.
pub fn n_bytes() -> u64 {
    let files = std::fs::read_dir(folder()).expect("the folder of fixtures");
    files.map(|file| file.and_then(|file| file.metadata()).map_or(0, |file| file.len())).sum()
}
