//! Equations of the book: an mdBook preprocessor that turns TeX between `$` or `$$` into `MathML`,
//! which browsers show without a script and without a network.

use std::fmt::Write as _;
use std::io::{Read, Write};

use anyhow::{Context, Result, bail};
use pulldown_cmark::{Event, Tag, TagEnd};
use pulldown_latex::config::{DisplayMode, RenderConfig};
use pulldown_latex::{Parser, Storage, push_mathml};
use serde_json::Value;

use crate::documents;

/// The word after `cargo xtask` with which mdBook calls it.
pub const WORD: &str = "math";

/// Answers mdBook: whether it can make what is asked for, or the book with its equations.
pub fn answer(words: &[String]) -> Result<()> {
    if let [asked, renderer] = words
        && asked == "supports"
    {
        if renderer != "html" {
            bail!("MathML is for HTML");
        }
        return Ok(());
    }
    let mut json = String::new();
    std::io::stdin().read_to_string(&mut json)?;
    let book = rendered(&json)?;
    std::io::stdout().write_all(book.as_bytes()).context("mdBook does not listen")
}

/// mdBook sends its settings and the book, and wants the book back.
fn rendered(json: &str) -> Result<String> {
    let mut sent: Value = serde_json::from_str(json).context("mdBook sent no JSON")?;
    let mut book = sent.get_mut(1).context("mdBook sent no book")?.take();
    render(&mut book)?;
    Ok(book.to_string())
}

/// Renders the equations of every chapter in a part of the book.
fn render(part: &mut Value) -> Result<()> {
    match part {
        Value::Array(items) => items.iter_mut().try_for_each(render),
        Value::Object(fields) => {
            let name = fields.get("name").map(Value::to_string).unwrap_or_default();
            if let Some(Value::String(content)) = fields.get_mut("content") {
                *content = with_mathml(content).with_context(|| format!("chapter {name}"))?;
            }
            fields.values_mut().try_for_each(render)
        }
        _ => Ok(()),
    }
}

/// Markdown with its equations as `MathML`.
fn with_mathml(text: &str) -> Result<String> {
    let mut new = String::new();
    let (mut done, mut is_code) = (0, false);
    for (event, range) in documents::events(text).into_offset_iter() {
        let (tex, display_mode) = match &event {
            Event::InlineMath(tex) => (tex, DisplayMode::Inline),
            Event::DisplayMath(tex) => (tex, DisplayMode::Block),
            Event::Start(Tag::CodeBlock(_)) | Event::End(TagEnd::CodeBlock) => {
                is_code = !is_code;
                continue;
            }
            Event::Text(words) if !is_code && words.contains('$') => {
                bail!("an equation that Markdown does not see as one: {words}");
            }
            _ => continue,
        };
        new += &text[done..range.start];
        let mathml = mathml(tex, display_mode)?;
        match display_mode {
            DisplayMode::Inline => new += &mathml,
            // A block of its own, in which Markdown means nothing.
            DisplayMode::Block => {
                let _ = write!(new, "\n<div class=\"equation\">{mathml}</div>\n");
            }
        }
        done = range.end;
    }
    Ok(new + &text[done..])
}

fn mathml(tex: &str, display_mode: DisplayMode) -> Result<String> {
    let storage = Storage::new();
    let events: Vec<_> = Parser::new(tex, &storage)
        .collect::<Result<_, _>>()
        .map_err(|error| anyhow::anyhow!("{error}"))
        .with_context(|| format!("cannot read the equation {tex}"))?;
    let mut mathml = String::new();
    let config = RenderConfig { display_mode, ..RenderConfig::default() };
    push_mathml(&mut mathml, events.into_iter().map(Ok::<_, std::fmt::Error>), config)?;
    // It writes these as they are.
    let mathml = mathml.replace("><<", ">&lt;<").replace(">><", ">&gt;<");
    Ok(unmarked(&mathml))
}

/// One line without what Markdown would take for its own.
fn unmarked(html: &str) -> String {
    let escaped = html.chars().map(|c| match c {
        '*' => String::from("&#42;"),
        '_' => String::from("&#95;"),
        '`' => String::from("&#96;"),
        '[' => String::from("&#91;"),
        '|' => String::from("&#124;"),
        '\n' => String::from(" "),
        c => c.to_string(),
    });
    escaped.collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equations_become_mathml_and_code_stays() {
        let text = "speed $v_n$ and `$code$`\n\n$$\\frac{a}{b} * |c|$$\n\n```text\n$x$\n```\n";
        let new = with_mathml(text).unwrap();
        assert!(new.contains("speed <math"), "{new}");
        assert!(new.contains("<div class=\"equation\"><math display=\"block\""), "{new}");
        assert!(new.contains("<mfrac>") && new.contains("&#124;"), "{new}");
        assert!(new.contains("`$code$`") && new.contains("```text\n$x$\n```"), "{new}");
    }

    #[test]
    fn a_faulty_equation_is_an_error() {
        for text in ["$\\frac{a}$", "$$\\nosuchcommand x$$", "$\\left( x$", "$$a\n- b$$"] {
            assert!(with_mathml(text).is_err(), "{text}");
        }
        let book = r#"[{}, {"items": [{"Chapter": {"name": "N", "content": "$\\frac{a}$"}}]}]"#;
        let error = format!("{:#}", rendered(book).unwrap_err());
        assert!(error.contains("chapter \"N\"") && error.contains("\\frac{a}"), "{error}");
    }

    #[test]
    fn every_chapter_is_rendered() {
        let book = r#"[{"root": "/x"}, {"items": [{"Chapter": {"name": "A", "content": "$a$",
            "sub_items": [{"Chapter": {"name": "B", "content": "$b$"}}]}}, "Separator"]}]"#;
        let new = rendered(book).unwrap();
        assert_eq!(new.matches("<math").count(), 2, "{new}");
        assert!(!new.contains("root"), "{new}");
        assert!(rendered("{}").is_err() && rendered("no").is_err());
    }

    #[test]
    fn html_is_what_it_makes() {
        let words = |words: &[&str]| words.iter().map(ToString::to_string).collect::<Vec<_>>();
        assert!(answer(&words(&["supports", "html"])).is_ok());
        assert!(answer(&words(&["supports", "epub"])).is_err());
    }
}
