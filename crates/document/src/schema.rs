//! The JSON schema of scenes, written from the tables of `parts.rs`.

use serde_json::{Map, Value, json};

use crate::fields::VERSION;
use crate::form::{DocumentPart, Form, Names, Range};
use crate::parts::{BY_NAME, PARTS, kinds, part};

/// The schema of a scene's document (JSON Schema 2020-12).
#[must_use]
pub fn scene_schema() -> Value {
    let mut defs = Map::from_iter([("triple".to_owned(), of_form(&Form::List(&crate::form::NUMBER, 3, 3)))]);
    let mut schema = of_part(part("scene"));
    let mut pending = refs(&schema);
    while let Some(name) = pending.pop() {
        if defs.contains_key(&name) {
            continue;
        }
        let named = PARTS.iter().find(|part| part.name == name).map(of_part);
        let found = named.or_else(|| definition(&name)).unwrap_or_default();
        pending.extend(refs(&found));
        defs.insert(name, found);
    }
    schema["$schema"] = json!("https://json-schema.org/draft/2020-12/schema");
    schema["title"] = json!("A scene of Wavesplat");
    schema["$defs"] = defs.into();
    schema
}

/// Names of the definitions that a schema refers to.
fn refs(schema: &Value) -> Vec<String> {
    match schema {
        Value::Object(fields) => {
            let own = fields.get("$ref").and_then(Value::as_str).and_then(|path| path.strip_prefix("#/$defs/"));
            own.map(str::to_owned).into_iter().chain(fields.values().flat_map(refs)).collect()
        }
        Value::Array(items) => items.iter().flat_map(refs).collect(),
        _ => Vec::new(),
    }
}

fn to(name: &str) -> Value {
    json!({"$ref": format!("#/$defs/{name}")})
}

/// The definition of a name that a form has somewhere.
fn definition(name: &str) -> Option<Value> {
    fn named(form: &Form, name: &str) -> Option<Value> {
        match form {
            Form::Def(own, form, about) if *own == name => Some(described(of_form(form), about)),
            Form::Def(_, form, _) | Form::Said(form, _) | Form::Absent(form) | Form::Named(_, form) => {
                named(form, name)
            }
            Form::List(form, ..) => named(form, name),
            Form::By(_, one, other) => named(one, name).or_else(|| named(other, name)),
            Form::Either(forms) | Form::Tuple(forms) => forms.iter().find_map(|form| named(form, name)),
            _ => None,
        }
    }
    PARTS.iter().flat_map(|part| part.fields).find_map(|field| named(&field.form, name))
}

fn described(mut schema: Value, about: &str) -> Value {
    if !about.is_empty() {
        schema["description"] = json!(about);
    }
    schema
}

fn of_part(part: &DocumentPart) -> Value {
    let shown = part.fields.iter().filter(|field| !matches!(field.form, Form::Never(_)));
    let properties: Map<String, Value> =
        shown.map(|field| (field.name.to_owned(), described(of_form(&field.form), field.about))).collect();
    let mut schema = described(json!({"type": "object"}), part.about);
    if !properties.is_empty() {
        schema["properties"] = properties.into();
    }
    if !part.is_open {
        schema["additionalProperties"] = json!(false);
    }
    let needed: Vec<&str> = part.needed().map(|field| field.name).collect();
    if !needed.is_empty() {
        schema["required"] = json!(needed);
    }
    if !part.either.is_empty() {
        schema["anyOf"] = part.either.iter().map(|names| json!({"required": names})).collect();
    }
    schema
}

fn of_form(form: &Form) -> Value {
    match form {
        Form::Any | Form::Never(_) => json!({}),
        Form::Version => json!({"const": VERSION}),
        Form::Null => json!({"type": "null"}),
        Form::Switch => json!({"type": "boolean"}),
        Form::Text => json!({"type": "string"}),
        Form::Number(range) => of_range(range),
        Form::Whole(least, most) => {
            let mut schema = json!({"type": "integer"});
            if *least > i64::MIN {
                schema["minimum"] = json!(least);
            }
            if *most < i64::MAX {
                schema["maximum"] = json!(most);
            }
            schema
        }
        Form::Operator => json!({"enum": BY_NAME}),
        Form::OneOf([name]) => json!({"const": name}),
        Form::OneOf(names) => json!({"enum": names}),
        Form::List(item, least, most) => {
            let mut schema = json!({"type": "array", "items": of_form(item)});
            if *least > 0 {
                schema["minItems"] = json!(least);
            }
            if *most < usize::MAX {
                schema["maxItems"] = json!(most);
            }
            schema
        }
        Form::Tuple(forms) => {
            let items: Vec<Value> = forms.iter().map(of_form).collect();
            json!({"type": "array", "minItems": forms.len(), "maxItems": forms.len(), "prefixItems": items})
        }
        Form::Point | Form::Direction => to("triple"),
        // Reports of Python hold their numbers in tuples, which are no arrays of the schema.
        Form::Made("look") => json!({"type": "object", "required": ["transfer_function"]}),
        Form::Made("shading") => json!({"type": "object"}),
        Form::Part(name) | Form::Made(name) | Form::Def(name, ..) => to(name),
        Form::By(_, with, without) => json!({"anyOf": [of_form(with), of_form(without)]}),
        Form::Measure => to("measure"),
        Form::OneField(of, _) => {
            let properties: Map<String, Value> = kinds(of).iter().map(|kind| ((*kind).to_owned(), to(kind))).collect();
            json!({
                "type": "object", "minProperties": 1, "maxProperties": 1, "additionalProperties": false,
                "properties": properties,
            })
        }
        Form::Named(names, form) => {
            let mut schema = json!({"type": "object", "additionalProperties": of_form(form)});
            match names {
                Names::Whole => schema["propertyNames"] = json!({"pattern": "^-?[0-9]+$"}),
                Names::OneOf(names) => schema["propertyNames"] = json!({"enum": names}),
            }
            schema
        }
        Form::Either(forms) => of_several(forms),
        Form::Said(form, _) | Form::Absent(form) => of_form(form),
    }
}

/// One of several forms: types alone in one list, names with null in another.
fn of_several(forms: &[Form]) -> Value {
    let schemas: Vec<Value> = forms.iter().map(of_form).collect();
    let types: Vec<&Value> =
        schemas.iter().filter_map(|one| one.as_object().filter(|one| one.len() == 1)?.get("type")).collect();
    if types.len() == schemas.len() {
        return json!({"type": types});
    }
    json!({"anyOf": schemas})
}

fn of_range(range: &Range) -> Value {
    let mut schema = json!({"type": "number"});
    let bounds = [
        ("minimum", range.least),
        ("exclusiveMinimum", range.above),
        ("maximum", range.most),
        ("exclusiveMaximum", range.below),
    ];
    for (name, bound) in bounds {
        if let Some(bound) = bound {
            schema[name] = if bound.fract() == 0.0 { json!(bound as i64) } else { json!(bound) };
        }
    }
    schema
}

/// The text of a value: what fits a line of 120 letters stands on one.
#[must_use]
pub fn written(value: &Value, indent: usize) -> String {
    let short = spaced(value);
    if indent * 2 + short.chars().count() <= 116 {
        return short;
    }
    let (inner, outer) = ("  ".repeat(indent + 1), "  ".repeat(indent));
    let lines = |lines: Vec<String>, open, close| format!("{open}\n{}\n{outer}{close}", lines.join(",\n"));
    match value {
        Value::Object(fields) => {
            let line = |(name, one): (&String, &Value)| format!("{inner}{}: {}", json!(name), written(one, indent + 1));
            lines(fields.iter().map(line).collect(), '{', '}')
        }
        Value::Array(items) => {
            lines(items.iter().map(|one| format!("{inner}{}", written(one, indent + 1))).collect(), '[', ']')
        }
        _ => short,
    }
}

fn spaced(value: &Value) -> String {
    let joined = |parts: Vec<String>| parts.join(", ");
    match value {
        Value::Object(fields) if fields.is_empty() => "{}".to_owned(),
        Value::Object(fields) => {
            format!(
                "{{ {} }}",
                joined(fields.iter().map(|(name, one)| format!("{}: {}", json!(name), spaced(one))).collect())
            )
        }
        Value::Array(items) => format!("[{}]", joined(items.iter().map(spaced).collect())),
        _ => value.to_string(),
    }
}
