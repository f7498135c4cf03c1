//! The page's types of the viewer's state, its lists of names, and the check that a document is a state.

use std::fmt::Write as _;

use serde_json::json;

use crate::fields::LARGEST;
use crate::form::{DocumentPart, Form, Names, Range};
use crate::parts::{
    BY_NAME, COMPOSITES, KERNELS, MAX_REGION_POINTS, OVERLAYS, PANES, QUALITIES, SLICE_COLORS, TURNINGS, kinds, part,
};

/// Parts of a state with the names of their types, each after those that it is made of.
const TYPES: [(&str, &str); 24] = [
    ("keep", "Box"),
    ("plane", "Plane"),
    ("camera", "Camera"),
    ("transfer_function", "TransferFunction"),
    ("transfer_function_2d", "TransferFunction2D"),
    ("light", "Light"),
    ("shading", "Shading"),
    ("look", "Look"),
    ("state_volume", "OpenVolume"),
    ("state_layer", "Layer"),
    ("label", "LabelLook"),
    ("state_labels", "Labels"),
    ("state_shape", "Shape"),
    ("quality", "Sampling"),
    ("state_render", "Render"),
    ("view_layout", "Layout"),
    ("normals", "Normals"),
    ("slices", "Slices"),
    ("measure", "Measure"),
    ("view_quality", "ViewQuality"),
    ("interface", "Interface"),
    ("view", "View"),
    ("state", "ViewerState"),
    ("cut_out", "Box"),
];

/// Lists of names that the page offers; forms of one of them say so.
const LISTS: [(&str, &[&str]); 6] = [
    ("COMPOSITES", &COMPOSITES),
    ("QUALITIES", &QUALITIES),
    ("KERNELS", &KERNELS),
    ("PANES", &PANES),
    ("SLICE_COLORS", &SLICE_COLORS),
    ("OVERLAYS", &OVERLAYS),
];

/// The text of the page's file of types and checks of the viewer's state.
#[must_use]
pub fn state_types() -> String {
    let mut text = String::from(
        "// Written by `make schema` from the tables of crates/document: types of the viewer's state, and its check.\n\n\
         import * as check from \"./checks.ts\";\n\n\
         export type Vec3 = readonly [number, number, number];\n",
    );
    let lists = LISTS.iter().copied().chain([("TURNINGS", &TURNINGS[..])]);
    for (name, names) in lists {
        let _ = writeln!(text, "export const {name} = {} as const;", spaced(names));
    }
    let _ = writeln!(
        text,
        "/** Largest number of corners of a region. */\nexport const MAX_REGION_POINTS = {MAX_REGION_POINTS};"
    );
    let shown = || TYPES.iter().filter(|(name, _)| *name != "cut_out");
    for (name, kind) in shown() {
        text += &interface(part(name), kind);
    }
    text += "\n// Checks, each after those that it is made of.\n\n";
    for (name, kind) in shown() {
        let fields = part(name).fields.iter().map(|field| {
            let mark = if field.is_needed { "" } else { "?" };
            format!("\n  {}: {},", quoted(&format!("{}{mark}", field.name)), checked(&field.form))
        });
        let export = if *name == "state" { "export " } else { "" };
        let object = format!("check.fields({{{}\n}})", fields.collect::<String>());
        let one = part(name).one_of;
        let object = if one.is_empty() { object } else { format!("check.oneGiven({}, {object})", spaced(one)) };
        let _ = writeln!(text, "{export}const {} = {object};", of(kind));
    }
    text
}

/// The name of the check of a type.
fn of(kind: &str) -> String {
    format!("is{kind}")
}

fn type_of(name: &str) -> &'static str {
    TYPES.iter().find(|(part, _)| *part == name).map_or("unknown", |(_, kind)| kind)
}

fn quoted(text: &str) -> String {
    let is_plain = text.bytes().all(|letter| letter.is_ascii_alphanumeric() || letter == b'_');
    if is_plain && !text.starts_with(|first: char| first.is_ascii_digit()) {
        text.to_owned()
    } else {
        json!(text).to_string()
    }
}

fn spaced(names: &[&str]) -> String {
    format!("[{}]", names.iter().map(|name| json!(name).to_string()).collect::<Vec<_>>().join(", "))
}

fn interface(part: &DocumentPart, kind: &str) -> String {
    let mut text = String::from("\n");
    if !part.about.is_empty() {
        let _ = writeln!(text, "/** {} */", part.about);
    }
    let _ = writeln!(text, "export interface {kind} {{");
    for field in part.fields {
        if !field.about.is_empty() {
            let _ = writeln!(text, "  /** {} */", field.about);
        }
        let mark = if field.is_sent { "" } else { "?" };
        let _ = writeln!(text, "  readonly {}{mark}: {};", quoted(field.name), typed(&field.form));
    }
    text + "}\n"
}

/// The type of the values of a form.
fn typed(form: &Form) -> String {
    let joined = |forms: &[Form]| {
        let mut types: Vec<String> = forms.iter().map(typed).collect();
        types.dedup();
        types.join(" | ")
    };
    match form {
        Form::Any | Form::Never(_) => "unknown".to_owned(),
        Form::Version => "1".to_owned(),
        Form::Null => "null".to_owned(),
        Form::Switch => "boolean".to_owned(),
        Form::Text | Form::Operator => "string".to_owned(),
        Form::Number(_) | Form::Whole(..) => "number".to_owned(),
        Form::OneOf(names) => match LISTS.iter().find(|(_, list)| list == names) {
            _ if *names == BY_NAME => "string".to_owned(),
            Some(("COMPOSITES", _)) => "string".to_owned(), // as texts of its own menus
            Some((name, _)) => format!("(typeof {name})[number]"),
            None => names.iter().map(|name| json!(name).to_string()).collect::<Vec<_>>().join(" | "),
        },
        Form::List(item, ..) => {
            let item = typed(item);
            if item.contains([' ', '|']) { format!("readonly ({item})[]") } else { format!("readonly {item}[]") }
        }
        Form::Tuple(forms) => format!("readonly [{}]", forms.iter().map(typed).collect::<Vec<_>>().join(", ")),
        Form::Point | Form::Direction => "Vec3".to_owned(),
        Form::Part(name) | Form::Made(name) => type_of(name).to_owned(),
        Form::Measure => "Measure".to_owned(),
        Form::By(_, with, without) => joined(&[**without, **with]),
        // The page makes operators by their names alone.
        Form::OneField("operator", _) => "Readonly<Record<string, Readonly<Record<string, number | null>>>>".to_owned(),
        Form::OneField(of, _) => {
            let types = kinds(of).iter().map(|kind| format!("{{ readonly {kind}: {} }}", type_of(kind)));
            types.collect::<Vec<_>>().join(" | ")
        }
        Form::Named(Names::Whole, form) => format!("Readonly<Record<string, {}>>", typed(form)),
        Form::Named(Names::OneOf(names), form) => {
            format!("Readonly<Record<{}, {}>>", typed(&Form::OneOf(names)), typed(form))
        }
        Form::Either(forms) => joined(forms),
        Form::Def(_, form, _) | Form::Said(form, _) | Form::Absent(form) => typed(form),
    }
}

/// The check of the values of a form.
fn checked(form: &Form) -> String {
    let all = |forms: &[Form]| forms.iter().map(checked).collect::<Vec<_>>().join(", ");
    match form {
        Form::Any | Form::Never(_) => "check.any".to_owned(),
        Form::Version => "check.oneOf(1)".to_owned(),
        Form::Null => "check.oneOf(null)".to_owned(),
        Form::Switch => "check.flag".to_owned(),
        Form::Text => "check.text".to_owned(),
        Form::Number(range) => number(range),
        Form::Whole(i64::MIN, _) => "check.integer()".to_owned(),
        Form::Whole(least, _) => format!("check.integer({least})"),
        Form::Operator => format!("check.oneOf(...COMPOSITES.slice(0, {}))", BY_NAME.len()),
        Form::OneOf(names) => match LISTS.iter().find(|(_, list)| list == names) {
            _ if *names == BY_NAME => format!("check.oneOf(...COMPOSITES.slice(0, {}))", BY_NAME.len()),
            Some((name, _)) => format!("check.oneOf(...{name})"),
            None => format!("check.oneOf({})", spaced(names).trim_matches(['[', ']'])),
        },
        Form::List(item, 0, usize::MAX) => format!("check.list({})", checked(item)),
        Form::List(item, least, usize::MAX) => format!("check.list({}, {least})", checked(item)),
        Form::List(item, least, most) => format!("check.list({}, {least}, {most})", checked(item)),
        Form::Tuple(forms) => format!("check.tuple({})", all(forms)),
        Form::Point => "check.point".to_owned(),
        Form::Direction => "check.direction".to_owned(),
        Form::Part(name) | Form::Made(name) => of(type_of(name)),
        Form::Measure => "check.measure(isMeasure)".to_owned(),
        Form::By(field, with, without) => {
            format!("check.by({}, {}, {})", json!(field), checked(with), checked(without))
        }
        Form::OneField(of, _) => {
            let one = |kind: &&str| match type_of(kind) {
                "unknown" => {
                    let fields = part(kind).fields.iter().map(|field| {
                        let mark = if field.is_needed { "" } else { "?" };
                        format!("{}: {}", quoted(&format!("{}{mark}", field.name)), checked(&field.form))
                    });
                    format!("{}: check.fields({{ {} }})", quoted(kind), fields.collect::<Vec<_>>().join(", "))
                }
                known => format!("{}: {}", quoted(kind), self::of(known)),
            };
            format!("check.oneField({{ {} }})", kinds(of).iter().map(one).collect::<Vec<_>>().join(", "))
        }
        Form::Named(Names::Whole, form) => format!("check.byNumber({})", checked(form)),
        Form::Named(Names::OneOf(names), form) => {
            let list = LISTS.iter().find(|(_, list)| list == names).map_or("[]", |(name, _)| name);
            format!("check.byName({list}, {})", checked(form))
        }
        Form::Either(forms) => format!("check.anyOf({})", all(forms)),
        Form::Absent(form) => format!("check.anyOf(check.oneOf(null), {})", checked(form)),
        Form::Def("share", ..) => "check.share".to_owned(),
        Form::Def(_, form, _) | Form::Said(form, _) => checked(form),
    }
}

fn number(range: &Range) -> String {
    let least =
        range.least.map(|least| least.to_string()).or_else(|| range.above.map(|_| "Number.MIN_VALUE".to_owned()));
    let most = range.most.or_else(|| range.below.map(f64::next_down));
    match (least, most) {
        (None, None) => "check.number()".to_owned(),
        (Some(least), None) => format!("check.number({least})"),
        (least, Some(most)) => format!("check.number({}, {most})", least.unwrap_or_else(|| format!("{}", -LARGEST))),
    }
}
