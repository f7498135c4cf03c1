//! Checks of values by their forms, and the words for what is wrong.

use crate::camera::CameraDocument;
use crate::curves::{CurvesDocument, TableDocument};
use crate::error::{FieldError, Found, quoted};
use crate::fields::{VERSION, check_object, check_one_of, check_point, number, point, wrong, wrong_at};
use crate::form::{Form, Names, Range};
use crate::look::{LookDocument, check_settings, lights};
use crate::node::{MAX_LETTERS, ValueNode};
use crate::parts::{BY_NAME, COMPOSITE_SYNONYMS, kinds, part};

const WHAT: &str = "scene";
/// Measures with their least and largest number of points.
const MEASURES: [(&str, usize, usize); 3] = [("distance", 2, 2), ("angle", 3, 3), ("area", 3, 200)];

impl Form {
    /// Words for a value that is not of this form.
    fn words(&self) -> String {
        match self {
            Self::Any => String::new(),
            Self::Never(words) | Self::Said(_, words) => (*words).to_owned(),
            Self::Version => format!("this release reads version {VERSION}"),
            Self::Null => "it must be null".to_owned(),
            Self::Switch => "it must be true or false".to_owned(),
            Self::Text => "it must be a text".to_owned(),
            Self::Number(range) => words_of_range(range),
            Self::Whole(i64::MIN, _) => "it must be a whole number".to_owned(),
            Self::Whole(least, i64::MAX) => format!("it must be a whole number of at least {least}"),
            Self::Whole(least, most) => format!("it must be a whole number, {least} to {most}"),
            Self::Operator => format!("use one of: {}", BY_NAME.join(", ")),
            Self::OneOf([name]) => format!("it must be '{name}'"),
            Self::OneOf(names) => format!("use one of: {}", names.join(", ")),
            Self::List(_, 0, usize::MAX) => "it must be a list".to_owned(),
            Self::List(_, 0, most) => format!("it must be a list of at most {most}"),
            Self::List(_, least, usize::MAX) => format!("it must be a list of at least {least}"),
            Self::List(_, least, most) if least == most => format!("it must be a list of {least}"),
            Self::List(_, least, most) => format!("it must be a list of {least} to {most}"),
            Self::Point | Self::Direction => "it must be three numbers, [x, y, z]".to_owned(),
            Self::Part(_) | Self::Made(_) | Self::By(..) | Self::Measure | Self::Named(..) => {
                "it must be an object".to_owned()
            }
            Self::Tuple(forms) => format!("it must be a list of {}", forms.len()),
            Self::OneField(kind, instead) => {
                format!("it must be {instead}an object of one field: {}", kinds(kind).join(", "))
            }
            Self::Either(forms) => {
                let mut words: Vec<String> = forms.iter().map(Self::words).collect();
                words.sort_by_key(|words| !words.starts_with("use "));
                words.dedup();
                let others = words.iter().skip(1).map(|words| words.trim_start_matches("it must be "));
                let said = others.fold(words[0].clone(), |said, other| format!("{said} or {other}"));
                if said.starts_with("use ") { said.replacen(" or ", ", or ", 1) } else { said }
            }
            Self::Def(_, form, _) | Self::Absent(form) => form.words(),
        }
    }

    /// Whether it takes objects.
    fn takes_objects(&self) -> bool {
        match self.plain() {
            Self::Part(_) | Self::Made(_) | Self::By(..) | Self::Measure | Self::OneField(..) | Self::Named(..) => true,
            Self::Either(forms) => forms.iter().any(Self::takes_objects),
            _ => false,
        }
    }

    /// Refuses a value that is not of this form.
    pub(crate) fn check<N: ValueNode>(&self, node: &N, at: &FieldPlace<'_>) -> Result<(), FieldError> {
        let checked = |is_right: bool| if is_right { Ok(()) } else { Err(at.wrong(node, &self.words())) };
        match self {
            Self::Any => Ok(()),
            Self::Never(words) => Err(at.fault(words)),
            Self::Version => checked(node.whole() == Some(VERSION)),
            Self::Null => checked(node.is_null()),
            Self::Switch => checked(node.is_switch()),
            Self::Text => checked(node.text().is_some()),
            Self::Number(range) => checked(number(node).is_some_and(|number| range.has(number))),
            Self::Whole(least, most) => checked(node.whole().is_some_and(|whole| (*least..=*most).contains(&whole))),
            Self::OneOf(names) => checked(node.text().is_some_and(|text| names.contains(&text.as_str()))),
            Self::Operator => checked(node.text().is_some_and(|text| {
                BY_NAME.contains(&text.as_str()) || COMPOSITE_SYNONYMS.iter().any(|(name, _)| *name == text)
            })),
            Self::Point => checked(node.is_list() && point(node).is_some()),
            Self::Direction => match point(node).filter(|_| node.is_list()) {
                Some([0.0, 0.0, 0.0]) => Err(at.wrong_value("zero".to_owned(), "a normal has a direction")),
                found => checked(found.is_some()),
            },
            Self::List(item, least, most) => {
                let items = node.items().filter(|items| node.is_list() && (*least..=*most).contains(&items.len()));
                let Some(items) = items else { return checked(false) };
                items.iter().enumerate().try_for_each(|(number, one)| item.check(one, &at.item(number)))
            }
            Self::Tuple(forms) => {
                let items = node.items().filter(|items| node.is_list() && items.len() == forms.len());
                let Some(items) = items else { return checked(false) };
                let mut numbered = forms.iter().zip(&items).enumerate();
                numbered.try_for_each(|(number, (form, one))| form.check(one, &at.item(number)))
            }
            Self::Part(name) => {
                check_fields_of(node, name, &FieldPlace { inside: &at.place(), name: String::new(), ..*at })
            }
            Self::Made(_) if !at.is_deep || !node.is_object() => checked(node.is_object()),
            Self::Made(name) => check_made(node, name, at),
            Self::By(field, with, without) => {
                if node.field(field).is_some() {
                    with.check(node, at)
                } else {
                    without.check(node, at)
                }
            }
            Self::Measure => check_measure(node, &at.place()),
            Self::Absent(_) if node.is_null() => Ok(()),
            Self::OneField(kind, _) => {
                let names = if node.is_object() { node.names() } else { Vec::new() };
                let inside = match &*names {
                    [name] => node.field(name).zip(kinds(kind).iter().find(|kind| *kind == name)),
                    _ => None,
                };
                let Some((inside, name)) = inside else { return Err(wrong_at(&at.place(), Some(node), &self.words())) };
                let place = at.place();
                Self::Part(name).check(&inside, &FieldPlace { inside: &place, name: (*name).to_owned(), ..*at })
            }
            Self::Named(names, form) => {
                if !node.is_object() {
                    return Err(wrong_at(&at.place(), Some(node), &self.words()));
                }
                let mut found = node.names();
                found.sort_unstable();
                let place = at.place();
                found.into_iter().try_for_each(|name| {
                    at.check_name(&name, names)?;
                    let inside = FieldPlace { inside: &place, name, ..*at };
                    node.field(&inside.name).map_or(Ok(()), |one| form.check(&one, &inside))
                })
            }
            Self::Either(forms) => {
                if forms.iter().any(|form| form.check(node, at).is_ok()) {
                    return Ok(());
                }
                // An object is as wrong as its own field.
                let are_objects = forms.iter().all(|form| form.takes_objects() || matches!(form, Self::Null));
                let of_objects = forms.iter().find(|form| (node.is_object() || are_objects) && form.takes_objects());
                Err(of_objects
                    .and_then(|form| form.check(node, at).err())
                    .unwrap_or_else(|| at.wrong(node, &self.words())))
            }
            Self::Def(_, form, _) | Self::Absent(form) => form.check(node, at),
            Self::Said(form, words) => form
                .check(node, at)
                .map_err(|error| if node.is_object() && form.takes_objects() { error } else { at.wrong(node, words) }),
        }
    }
}

/// Refuses an object that is not as a part.
pub(crate) fn check_fields_of<N: ValueNode>(node: &N, name: &str, at: &FieldPlace<'_>) -> Result<(), FieldError> {
    check_names_of(node, name, at.inside)?;
    part(name).fields.iter().try_for_each(|field| match node.field(field.name) {
        Some(value) => field.form.check(&value, &FieldPlace { name: field.name.to_owned(), ..*at }),
        None => Ok(()),
    })
}

/// Refuses an object that another type is read from: as that reads it, and by the values of its fields.
fn check_made<N: ValueNode>(node: &N, name: &str, at: &FieldPlace<'_>) -> Result<(), FieldError> {
    let place = at.place();
    match name {
        "camera" => CameraDocument::read(node).map(drop).map_err(|error| error.inside(WHAT))?,
        "look" => {
            let curves = LookDocument::read_part(node, true).map_err(|error| error.inside(&place))?.transfer_function;
            let is_table = curves.field("rgba").is_some();
            let read = if is_table {
                TableDocument::read(&curves).map(drop)
            } else {
                CurvesDocument::read(&curves, true).map(drop)
            };
            read.map_err(|error| error.inside(&place))?;
        }
        "shading" => {
            let read = lights(node).and_then(|lights| lights.iter().try_for_each(|light| check_settings(light, true)));
            read.and_then(|()| check_settings(node, false)).map_err(|error| error.inside(WHAT))?;
        }
        _ => {}
    }
    check_fields_of(node, name, &FieldPlace { inside: &place, name: String::new(), is_dotted: name == "view", ..*at })
}

/// Refuses what is no object, or has not the fields of a part, whatever their values.
pub(crate) fn check_names_of<N: ValueNode>(node: &N, name: &str, place: &str) -> Result<(), FieldError> {
    let part = part(name);
    if !node.is_object() {
        return Err(wrong_at(place, Some(node), part.words.unwrap_or("it must be an object")));
    }
    let missing = |name: &str| FieldError {
        document: place.to_owned(),
        path: name.to_owned(),
        found: Found::Missing,
        wanted: String::new(),
    };
    if let Some(field) = part.needed().find(|field| node.field(field.name).is_none()) {
        return Err(missing(field.name));
    }
    if !part.is_open {
        let known: Vec<&str> = part.fields.iter().map(|field| field.name).collect();
        check_object(node, place, &known)?;
    }
    if let Some(last) = part.either.last()
        && !part.either.iter().any(|names| names.iter().all(|name| node.field(name).is_some()))
    {
        // The field that the writer forgot is one of those with which others were given.
        let begun = part.either.iter().find(|names| names.iter().any(|name| node.field(name).is_some()));
        let lacked = begun.unwrap_or(last).iter().find(|name| node.field(name).is_none());
        return Err(missing(lacked.unwrap_or(&last[0])));
    }
    Ok(())
}

/// The place of a value in a document. `inside`: of the object that has it, such as "scene: layers\[0\]"; `name`: of the
/// field, with the numbers of items in it; `is_dotted`: whether messages join both by a dot.
pub(crate) struct FieldPlace<'a> {
    pub inside: &'a str,
    pub name: String,
    pub is_dotted: bool,
    /// Whether cameras, looks and light are checked too, which say themselves what is wrong where they are made.
    pub is_deep: bool,
}

impl FieldPlace<'_> {
    /// The place of the value itself.
    fn place(&self) -> String {
        let Self { inside, name, .. } = self;
        match name.as_str() {
            "" => (*inside).to_owned(),
            _ if *inside == "scene" => format!("{inside}: {name}"),
            _ => format!("{inside}.{name}"),
        }
    }

    fn item(&self, number: usize) -> Self {
        Self { name: format!("{}[{number}]", self.name), ..*self }
    }

    fn fault(&self, wanted: &str) -> FieldError {
        FieldError { document: self.place(), path: String::new(), found: Found::Fault, wanted: wanted.to_owned() }
    }

    fn wrong_value(&self, found: String, wanted: &str) -> FieldError {
        if self.is_dotted || self.name.is_empty() {
            let found = Found::Whole("is", found);
            return FieldError { document: self.place(), path: String::new(), found, wanted: wanted.to_owned() };
        }
        wrong(self.inside, &self.name, found, wanted)
    }

    fn wrong<N: ValueNode>(&self, node: &N, wanted: &str) -> FieldError {
        // Short lists of numbers are written out.
        let is_of_numbers = node.items().is_some_and(|items| items.iter().all(|one| one.number().is_some()));
        let text = is_of_numbers.then(|| node.written()).filter(|text| text.chars().count() <= MAX_LETTERS);
        self.wrong_value(text.unwrap_or_else(|| node.described()), wanted)
    }

    fn check_name(&self, name: &str, names: &Names) -> Result<(), FieldError> {
        match names {
            Names::OneOf(known) if known.contains(&name) => Ok(()),
            Names::OneOf(known) => {
                let mut known = known.to_vec();
                known.sort_unstable();
                let wanted = format!("the fields are {}", known.join(", "));
                Err(FieldError { document: self.place(), path: name.to_owned(), found: Found::Unknown, wanted })
            }
            Names::Whole => {
                let digits = name.strip_prefix('-').unwrap_or(name);
                if !digits.is_empty() && digits.bytes().all(|digit| digit.is_ascii_digit()) {
                    return Ok(());
                }
                let wanted = format!("{} in field {} is no whole number", quoted(name), quoted(&self.name));
                let document = self.inside.to_owned();
                Err(FieldError { document, path: String::new(), found: Found::Fault, wanted })
            }
        }
    }
}

/// Words for what is no number within bounds.
fn words_of_range(range: &Range) -> String {
    match (range.least.or(range.above), range.most.or(range.below)) {
        (Some(low), Some(high)) => format!("it must be a number, {low} to {high}"),
        (Some(0.0), None) if range.above.is_some() => "it must be a positive number".to_owned(),
        (Some(low), None) => format!("it must be a number of at least {low}"),
        _ => "it must be a number".to_owned(),
    }
}

fn check_measure(measure: &impl ValueNode, place: &str) -> Result<(), FieldError> {
    check_object(measure, place, &["kind", "points"])?;
    let kind = measure.field("kind");
    check_one_of(kind.as_ref(), &MEASURES.map(|(name, ..)| name), &format!("{place}.kind"))?;
    let kind = kind.and_then(|kind| kind.text());
    let (least, most) =
        MEASURES.into_iter().find(|(name, ..)| kind.as_deref() == Some(name)).map_or((0, 0), |m| (m.1, m.2));
    let points = measure.field("points");
    let place = format!("{place}.points");
    let items = points.as_ref().filter(|points| points.is_list()).and_then(ValueNode::items);
    let Some(items) = items.filter(|items| (least..=most).contains(&items.len())) else {
        let n = if least == most { least.to_string() } else { format!("{least} to {most}") };
        return Err(wrong_at(&place, points.as_ref(), &format!("it must be a list of {n} points")));
    };
    for (number, point) in items.iter().enumerate() {
        check_point(point, &format!("{place}[{number}]"))?;
    }
    Ok(())
}
