//! A TOML document that says where each of its keys stands, and a reader of Rust types that
//! blames the key.

mod fault;

use plant_core::{Dt, must};
use serde::de::value::StrDeserializer;
use serde::de::{
    self, DeserializeOwned, DeserializeSeed, Deserializer, EnumAccess, IntoDeserializer, MapAccess,
    SeqAccess, Unexpected, VariantAccess, Visitor,
};
use serde::forward_to_deserialize_any;
use toml::Spanned;
use toml::de::{DeString, DeTable, DeValue};

use crate::read::error::{self, InputError, listed, shown};
use fault::{Fault, Kind, advice, joined, of_table};

/// The step for which a document's parameters are checked; which are sound does not depend on it.
pub(crate) const CHECK_DT: Dt = must!(Dt::from_s(0.001));

/// A TOML document, parsed, with the place of every key.
pub(crate) struct Document<'a> {
    file: &'a str,
    text: &'a str,
    root: DeValue<'a>,
}

/// Where a field stands in a document.
pub(crate) struct Place {
    /// Its key, or the nearest table around it that is there.
    offset: usize,
    /// Its full path, as far as it is there.
    path: Vec<String>,
    /// Its value as written; none where the key is not there.
    value: Option<String>,
}

impl<'a> Document<'a> {
    /// Parses `bytes`; `file` is for messages.
    pub(crate) fn parse(file: &'a str, bytes: &'a [u8]) -> Result<Self, InputError> {
        let text = error::text(file, bytes)?;
        match DeTable::parse(text) {
            Ok(root) => Ok(Self { file, text, root: DeValue::Table(root.into_inner()) }),
            Err(e) => {
                let offset = e.span().map_or(text.len(), |span| span.start);
                let message = e.message().lines().collect::<Vec<_>>().join("; ");
                Err(InputError::at(file, text, offset, message))
            }
        }
    }

    /// Reads a value whose keys all have their place in it.
    pub(crate) fn read<T: DeserializeOwned>(&self) -> Result<T, InputError> {
        let node = Node { value: &self.root, offset: 0, path: String::new() };
        T::deserialize(node).map_err(|fault| {
            InputError::at(self.file, self.text, fault.offset.unwrap_or(0), fault.message)
        })
    }

    /// Finds the field `a.b.c`; a table that only names a variant may be left out of the path, a
    /// number counts the tables of a list.
    pub(crate) fn locate(&self, field: &str) -> Place {
        let mut place = Place { offset: 0, path: Vec::new(), value: None };
        let mut value = &self.root;
        for part in field.split('.') {
            let listed = part.parse().ok().and_then(|n: usize| value.as_array()?.get(n));
            if let Some(item) = listed {
                place.offset = item.span().start;
                value = item.get_ref();
                continue;
            }
            let Some((key, found)) = entry(value, part).or_else(|| {
                let (variant, inner) = only_entry(value)?;
                let inside = entry(inner.get_ref(), part)?;
                place.path.push(variant.get_ref().to_string());
                Some(inside)
            }) else {
                return place;
            };
            place.offset = key.span().start;
            place.path.push(part.to_owned());
            place.value = None;
            value = found.get_ref();
            if !value.is_table() {
                place.value = self.text.get(found.span()).map(shown);
            }
        }
        place
    }

    /// A rule that the value of `field` breaks.
    pub(crate) fn refusal(&self, field: &str, rule: &str) -> InputError {
        let place = self.locate(field);
        let message = match (place.path.split_last(), &place.value) {
            (Some((key, tables)), Some(value)) => {
                format!("{} {rule}, found {value}", of_table(key, &tables.join(".")))
            }
            _ => format!("`{field}` {rule}"),
        };
        InputError::at(self.file, self.text, place.offset, message)
    }
}

impl Place {
    /// Whether the field itself is there.
    pub(crate) const fn is_found(&self) -> bool {
        self.value.is_some()
    }
}

type Key<'a> = Spanned<DeString<'a>>;
type Entry<'n, 'a> = (&'n Key<'a>, &'n Spanned<DeValue<'a>>);

fn entry<'n, 'a>(value: &'n DeValue<'a>, key: &str) -> Option<Entry<'n, 'a>> {
    value.as_table()?.iter().find(|(k, _)| k.get_ref() == key)
}

fn only_entry<'n, 'a>(value: &'n DeValue<'a>) -> Option<Entry<'n, 'a>> {
    let table = value.as_table()?;
    if table.len() == 1 { table.iter().next() } else { None }
}

/// The entries of a table in the order of the file.
fn in_order<'n, 'a>(table: &'n DeTable<'a>) -> Vec<Entry<'n, 'a>> {
    let mut entries: Vec<_> = table.iter().collect();
    entries.sort_by_key(|(key, _)| key.span().start);
    entries
}

/// A value of the document that becomes one of a Rust type.
struct Node<'n, 'a> {
    value: &'n DeValue<'a>,
    offset: usize,
    path: String,
}

impl<'n, 'a> Node<'n, 'a> {
    fn child(&self, (key, value): Entry<'n, 'a>) -> Self {
        Self {
            value: value.get_ref(),
            // A table is best found by its name, anything else by what is written.
            offset: if value.get_ref().is_table() { key.span() } else { value.span() }.start,
            path: joined(&self.path, key.get_ref()),
        }
    }

    fn visit<'de, V: Visitor<'de>>(&self, visitor: V) -> Result<V::Value, Fault> {
        match self.value {
            DeValue::String(text) => visitor.visit_str(text),
            DeValue::Boolean(b) => visitor.visit_bool(*b),
            DeValue::Integer(n) => match i64::from_str_radix(n.as_str(), n.radix()) {
                Ok(n) => visitor.visit_i64(n),
                Err(_) => Err(de::Error::custom("the number is too large")),
            },
            DeValue::Float(x) => match x.as_str().parse() {
                Ok(x) => visitor.visit_f64(x),
                Err(_) => Err(de::Error::custom("expected a number")),
            },
            DeValue::Datetime(_) => {
                Err(de::Error::invalid_type(Unexpected::Other("a date"), &visitor))
            }
            DeValue::Array(values) => {
                visitor.visit_seq(List { node: self, values: values.iter(), index: 0 })
            }
            DeValue::Table(table) => visitor.visit_map(Table {
                node: self,
                rest: in_order(table).into_iter(),
                next: None,
            }),
        }
    }
}

impl<'de> Deserializer<'de> for Node<'_, '_> {
    type Error = Fault;

    fn deserialize_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Fault> {
        self.visit(visitor).map_err(|fault| fault.or_at(self.offset, &self.path))
    }

    /// Read from the text straight to single precision, so that it is rounded once, as a Rust
    /// literal is.
    fn deserialize_f32<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Fault> {
        let text = match self.value {
            DeValue::Float(x) => x.as_str(),
            DeValue::Integer(n) if n.radix() == 10 => n.as_str(),
            _ => return self.deserialize_any(visitor),
        };
        match text.parse::<f32>() {
            Ok(x) if x.is_finite() || text.contains("inf") || text.contains("nan") => {
                visitor.visit_f32(x)
            }
            Ok(_) => Err(de::Error::custom("the number is too large (inf for no limit)")),
            Err(_) => Err(de::Error::custom("expected a number")),
        }
        .map_err(|fault: Fault| fault.or_at(self.offset, &self.path))
    }

    fn deserialize_u16<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Fault> {
        let found = match self.value {
            DeValue::Float(x) => x.as_str(),
            DeValue::Integer(n) => match n.as_str().parse::<u16>() {
                Ok(whole) => return visitor.visit_u16(whole),
                Err(_) => n.as_str(),
            },
            _ => return self.deserialize_any(visitor),
        };
        let fault: Fault =
            de::Error::custom(format!("expected a whole number up to {}, found {found}", u16::MAX));
        Err(fault.or_at(self.offset, &self.path))
    }

    /// A derived reader would take a list too, by position.
    fn deserialize_struct<V: Visitor<'de>>(
        self,
        _name: &'static str,
        _fields: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Fault> {
        if self.value.is_array() {
            let fault: Fault = de::Error::invalid_type(Unexpected::Seq, &visitor);
            return Err(fault.or_at(self.offset, &self.path));
        }
        self.deserialize_any(visitor)
    }

    fn deserialize_option<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Fault> {
        visitor.visit_some(self)
    }

    fn deserialize_newtype_struct<V: Visitor<'de>>(
        self,
        _name: &'static str,
        visitor: V,
    ) -> Result<V::Value, Fault> {
        visitor.visit_newtype_struct(self)
    }

    fn deserialize_enum<V: Visitor<'de>>(
        self,
        _name: &'static str,
        variants: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Fault> {
        let (offset, path) = (self.offset, self.path.clone());
        let misplaced = |found: &str| {
            let expected = listed(variants.iter().copied());
            <Fault as de::Error>::custom(format_args!("expected one of {expected}, found {found}"))
        };
        match self.value {
            DeValue::String(text) => {
                let name: StrDeserializer<'_, Fault> = text.as_ref().into_deserializer();
                visitor.visit_enum(name)
            }
            DeValue::Table(table) => {
                let entries = in_order(table);
                let unknown =
                    entries.iter().find(|(key, _)| !variants.contains(&key.get_ref().as_ref()));
                match (unknown.or(entries.first()), entries.get(1)) {
                    (Some(&first), second) if unknown.is_some() || second.is_none() => {
                        visitor.visit_enum(Variant { node: self, entry: first })
                    }
                    (_, Some((key, _))) => Err(Fault::told(
                        key.span().start,
                        format!(
                            "only one of {} may stand in [{}]",
                            listed(variants.iter().copied()),
                            shown(&path)
                        ),
                    )),
                    _ => Err(misplaced("an empty table")),
                }
            }
            DeValue::Array(_) => Err(misplaced("a list")),
            DeValue::Boolean(_) => Err(misplaced("true or false")),
            DeValue::Datetime(_) => Err(misplaced("a date")),
            DeValue::Integer(_) | DeValue::Float(_) => Err(misplaced("a number")),
        }
        .map_err(|fault| fault.or_at(offset, &path))
    }

    forward_to_deserialize_any! {
        bool i8 i16 i32 i64 i128 u8 u32 u64 u128 f64 char str string bytes byte_buf unit
        unit_struct seq tuple tuple_struct map identifier ignored_any
    }
}

/// The elements of a list.
struct List<'c, 'n, 'a> {
    node: &'c Node<'n, 'a>,
    values: std::slice::Iter<'n, Spanned<DeValue<'a>>>,
    index: usize,
}

impl<'de> SeqAccess<'de> for List<'_, '_, '_> {
    type Error = Fault;

    fn next_element_seed<T: DeserializeSeed<'de>>(
        &mut self,
        seed: T,
    ) -> Result<Option<T::Value>, Fault> {
        let Some(value) = self.values.next() else { return Ok(None) };
        let path = format!("{}[{}]", self.node.path, self.index);
        self.index += 1;
        seed.deserialize(Node { value: value.get_ref(), offset: value.span().start, path })
            .map(Some)
    }

    fn size_hint(&self) -> Option<usize> {
        Some(self.values.len())
    }
}

/// The entries of a table.
struct Table<'c, 'n, 'a> {
    node: &'c Node<'n, 'a>,
    rest: std::vec::IntoIter<Entry<'n, 'a>>,
    next: Option<Entry<'n, 'a>>,
}

/// Reads a key; an unknown one is blamed on it.
fn read_key<'de, T: DeserializeSeed<'de>>(
    seed: T,
    (key, value): Entry<'_, '_>,
    table: &str,
) -> Result<T::Value, Fault> {
    let name: StrDeserializer<'_, Fault> = key.get_ref().as_ref().into_deserializer();
    seed.deserialize(name).map_err(|fault| {
        let offset = key.span().start;
        match &fault.kind {
            Kind::UnknownName(name, known) if value.get_ref().is_table() => {
                let (full, advice) = (joined(table, name), advice(name, known, Some(table)));
                Fault::told(offset, format!("unknown table [{}]; {advice}", shown(&full)))
            }
            Kind::UnknownName(name, known) => {
                let advice = advice(name, known, None);
                Fault::told(offset, format!("unknown key {}; {advice}", of_table(name, table)))
            }
            _ => fault.or_at(offset, table),
        }
    })
}

impl<'de> MapAccess<'de> for Table<'_, '_, '_> {
    type Error = Fault;

    fn next_key_seed<K: DeserializeSeed<'de>>(
        &mut self,
        seed: K,
    ) -> Result<Option<K::Value>, Fault> {
        self.next = self.rest.next();
        self.next.map(|entry| read_key(seed, entry, &self.node.path)).transpose()
    }

    fn next_value_seed<V: DeserializeSeed<'de>>(&mut self, seed: V) -> Result<V::Value, Fault> {
        match self.next.take() {
            Some(entry) => seed.deserialize(self.node.child(entry)),
            None => Err(de::Error::custom("a value without its key")),
        }
    }
}

/// The one entry of a table that stands for a variant.
struct Variant<'n, 'a> {
    node: Node<'n, 'a>,
    entry: Entry<'n, 'a>,
}

impl<'de, 'n, 'a> EnumAccess<'de> for Variant<'n, 'a> {
    type Error = Fault;
    type Variant = Content<'n, 'a>;

    fn variant_seed<V: DeserializeSeed<'de>>(
        self,
        seed: V,
    ) -> Result<(V::Value, Content<'n, 'a>), Fault> {
        let variant = read_key(seed, self.entry, &self.node.path)?;
        Ok((variant, Content(self.node.child(self.entry))))
    }
}

/// What a variant holds.
struct Content<'n, 'a>(Node<'n, 'a>);

impl<'de> VariantAccess<'de> for Content<'_, '_> {
    type Error = Fault;

    fn unit_variant(self) -> Result<(), Fault> {
        let fault: Fault = de::Error::custom("expected its name alone, as a text");
        Err(fault.or_at(self.0.offset, &self.0.path))
    }

    fn newtype_variant_seed<T: DeserializeSeed<'de>>(self, seed: T) -> Result<T::Value, Fault> {
        seed.deserialize(self.0)
    }

    fn tuple_variant<V: Visitor<'de>>(self, _len: usize, visitor: V) -> Result<V::Value, Fault> {
        self.0.deserialize_any(visitor)
    }

    fn struct_variant<V: Visitor<'de>>(
        self,
        fields: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Fault> {
        self.0.deserialize_struct("", fields, visitor)
    }
}
