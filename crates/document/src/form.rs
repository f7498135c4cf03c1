//! Forms of values: what a field takes. `parts.rs` has tables of them, `check.rs` says what is wrong.

/// The values that a field takes.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Form {
    /// Anything: it is checked where it is used.
    Any,
    /// Nothing: the field is known for its message alone.
    Never(&'static str),
    /// The version of the documents of this release.
    Version,
    Null,
    Switch,
    Text,
    Number(Range),
    Whole(i64, i64),
    OneOf(&'static [&'static str]),
    /// An operator by its name alone: the last needs its number.
    Operator,
    /// A list with its least and largest number of items.
    List(&'static Form, usize, usize),
    /// Three numbers.
    Point,
    /// Three numbers that are not all zero.
    Direction,
    /// A list of values of a form each.
    Tuple(&'static [Form]),
    /// An object with the fields of a part.
    Part(&'static str),
    /// An object with the fields of a part, which are read where it is made: camera, look, light.
    Made(&'static str),
    /// An object of one form if it has a field, else of another.
    By(&'static str, &'static Form, &'static Form),
    /// A measure with the points of its kind.
    Measure,
    /// An object of one field, which names one of some kinds; the words before them in messages.
    OneField(&'static str, &'static str),
    /// An object whose fields are all of a form. Their names are whole numbers, or from a list.
    Named(Names, &'static Form),
    /// One of several.
    Either(&'static [Form]),
    /// A form, or null for a field that is not there; the schema has it without null.
    Absent(&'static Form),
    /// A form of a name, under which the schema has it; a sentence about it.
    Def(&'static str, &'static Form, &'static str),
    /// A form with words of its own for what is wrong.
    Said(&'static Form, &'static str),
}

/// Names of the fields of an object that are all of one form.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Names {
    Whole,
    OneOf(&'static [&'static str]),
}

/// Bounds of a number. `least` and `most` are within, `above` and `below` are not.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Range {
    pub least: Option<f64>,
    pub above: Option<f64>,
    pub most: Option<f64>,
    pub below: Option<f64>,
}

pub(crate) const UNBOUND: Range = Range { least: None, above: None, most: None, below: None };
pub(crate) const NUMBER: Form = Form::Number(UNBOUND);
pub(crate) const NOT_NEGATIVE: Form = Form::Number(Range { least: Some(0.0), ..UNBOUND });
pub(crate) const POSITIVE: Form = Form::Number(Range { above: Some(0.0), ..UNBOUND });
pub(crate) const SHARE: Form = Form::Def("share", &Form::Number(WITHIN_1), "");
const WITHIN_1: Range = Range { least: Some(0.0), most: Some(1.0), ..UNBOUND };

impl Range {
    /// Whether a number is within.
    pub fn has(&self, number: f64) -> bool {
        self.least.is_none_or(|least| number >= least)
            && self.above.is_none_or(|above| number > above)
            && self.most.is_none_or(|most| number <= most)
            && self.below.is_none_or(|below| number < below)
    }
}

impl Form {
    /// The form itself, without its name and its words.
    pub(crate) const fn plain(&self) -> &Self {
        match self {
            Self::Def(_, form, _) | Self::Said(form, _) | Self::Absent(form) => form.plain(),
            _ => self,
        }
    }
}

/// A part of a document: an object and its fields.
pub(crate) struct DocumentPart {
    pub name: &'static str,
    /// A sentence about it, for the schema.
    pub about: &'static str,
    pub fields: &'static [FieldForm],
    /// Of these sets of fields one at least must be there.
    pub either: &'static [&'static [&'static str]],
    /// Of these fields exactly one has a value, which the reader of the part says.
    pub one_of: &'static [&'static str],
    /// Whether it may have other fields too.
    pub is_open: bool,
    /// Words for what is no object.
    pub words: Option<&'static str>,
}

/// A field of a part.
pub(crate) struct FieldForm {
    pub name: &'static str,
    pub form: Form,
    pub is_needed: bool,
    /// Whether states have it that the session sends to the page, which may leave it out.
    pub is_sent: bool,
    pub about: &'static str,
}

impl DocumentPart {
    /// The fields that must be there.
    pub fn needed(&self) -> impl Iterator<Item = &FieldForm> {
        self.fields.iter().filter(|field| field.is_needed)
    }
}

impl FieldForm {
    /// The field as one that the session's states have.
    pub const fn sent(self) -> Self {
        Self { is_sent: true, ..self }
    }

    /// The field with a sentence about it.
    pub const fn about(self, about: &'static str) -> Self {
        Self { about, ..self }
    }
}
