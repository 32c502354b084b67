//! A page that needs nothing but itself: style, script, plotting library and numbers are in it.

use std::fmt::{Display, Write};

use super::data;
use crate::show::plot::Sheet;

const STYLE: &str = include_str!("report.css");
const SCRIPT: &str = include_str!("report.js");
/// The book's live page has these, too.
const PLOTS: &str = include_str!("plots.js");
const PLOTS_STYLE: &str = include_str!("plots.css");
const UPLOT: &str = include_str!("uplot/uPlot.iife.min.js");
const UPLOT_STYLE: &str = include_str!("uplot/uPlot.min.css");
const UPLOT_LICENCE: &str = include_str!("uplot/LICENSE");

/// Nothing may be fetched, whatever the text of a page holds.
const POLICY: &str = "default-src 'none'; style-src 'unsafe-inline'; script-src 'unsafe-inline'; \
                      base-uri 'none'; form-action 'none'";

/// What stands around the plots, for hands and eyes.
const TOOLS: &str = r#"<div class="tools" role="toolbar" aria-label="Time axis of all plots">
<button type="button" id="zoom-in" aria-label="Zoom in">+</button>
<button type="button" id="zoom-out" aria-label="Zoom out">−</button>
<button type="button" id="left" aria-label="Earlier">←</button>
<button type="button" id="right" aria-label="Later">→</button>
<button type="button" id="reset">All</button>
<output id="view" aria-live="polite"></output>
<span class="hint quiet">drag to zoom, double-click for all; on a plot + − 0 ← →, with Shift to read values</span>
</div>
<noscript><p>The plots need JavaScript; <code>trace.csv</code> and <code>report.svg</code> beside this file do not.</p></noscript>
"#;

/// A page in the making.
pub struct Page {
    title: String,
    body: String,
    entries: Vec<(&'static str, &'static str)>,
    lead: String,
    data: Option<String>,
}

impl Page {
    /// With a headline, and a line for each of what should be known first.
    pub fn new(title: &str, lead: &[String]) -> Self {
        let lead: Vec<_> = lead.iter().map(|line| format!("<p>{}</p>\n", escaped(line))).collect();
        let (body, entries) = (String::new(), Vec::new());
        Self { title: title.to_owned(), body, entries, lead: lead.concat(), data: None }
    }

    /// A section of HTML; none where there is nothing to show.
    pub fn section(&mut self, id: &'static str, heading: &'static str, html: &str) {
        if html.is_empty() {
            return;
        }
        self.entries.push((id, heading));
        let _ = write!(
            self.body,
            "<section id=\"{id}\" aria-labelledby=\"{id}-heading\">\n\
             <h2 id=\"{id}-heading\">{heading}</h2>\n{html}</section>\n"
        );
    }

    /// What the reader should know.
    pub fn notes<'a>(&mut self, notes: impl Iterator<Item = &'a String>) {
        let items: Vec<_> = notes.map(|note| format!("<li>{}</li>\n", escaped(note))).collect();
        if !items.is_empty() {
            self.section(
                "notes",
                "Notes",
                &format!("<ul class=\"notes\">\n{}</ul>\n", items.concat()),
            );
        }
    }

    /// The plots of a sheet over one time axis.
    pub fn plots(&mut self, sheet: &Sheet) -> anyhow::Result<()> {
        if sheet.time_s.len() < 2 {
            return Ok(());
        }
        let mut html = TOOLS.to_owned();
        for panel in &sheet.panels {
            let title = escaped(&panel.title);
            let unit = escaped(&panel.unit);
            let unit = if unit.is_empty() { unit } else { format!(" [{unit}]") };
            let _ = write!(
                html,
                "<figure class=\"plot\" tabindex=\"0\" aria-label=\"{title} over time\">\n\
                 <h3>{title}{unit}</h3>\n<div class=\"area\"></div>\n\
                 <figcaption class=\"range\"></figcaption>\n</figure>\n"
            );
        }
        self.section("plots", "Over time", &html);
        self.data = Some(data::json(sheet)?);
        Ok(())
    }

    /// The whole of it.
    pub fn bytes(self) -> Vec<u8> {
        let title = escaped(&self.title);
        let links: Vec<_> = self
            .entries
            .iter()
            .map(|(id, name)| format!("<a href=\"#{id}\">{name}</a>\n"))
            .collect();
        let mut page = format!(
            "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
             <meta http-equiv=\"Content-Security-Policy\" content=\"{POLICY}\">\n\
             <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
             <meta name=\"color-scheme\" content=\"light dark\">\n<title>{title}</title>\n"
        );
        if self.data.is_some() {
            let _ = write!(page, "<style>\n{UPLOT_STYLE}\n{PLOTS_STYLE}</style>\n");
        }
        let _ = write!(
            page,
            "<style>\n{STYLE}</style>\n</head>\n<body>\n<header>\n<h1>{title}</h1>\n{}\
             <nav aria-label=\"Sections\">\n{links}</nav>\n</header>\n<main>\n{}</main>\n\
             <footer>\n<p>Written by voltstep {}.</p>\n",
            self.lead,
            self.body,
            env!("CARGO_PKG_VERSION"),
            links = links.concat(),
        );
        if let Some(data) = self.data {
            let _ = write!(
                page,
                "<details><summary>Plots drawn by uPlot, MIT licence</summary>\n<pre>{}</pre></details>\n\
                 </footer>\n<script type=\"application/json\" id=\"data\">{data}</script>\n\
                 <script>\n{UPLOT}\n</script>\n<script>\n{PLOTS}</script>\n",
                escaped(UPLOT_LICENCE)
            );
        } else {
            page += "</footer>\n";
        }
        let _ = write!(page, "<script>\n{SCRIPT}</script>\n</body>\n</html>\n");
        page.into_bytes()
    }
}

/// Text that is nothing but text, between tags and between quotes.
pub fn escaped(text: &str) -> String {
    let mut safe = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => safe += "&amp;",
            '<' => safe += "&lt;",
            '>' => safe += "&gt;",
            '"' => safe += "&quot;",
            '\'' => safe += "&#39;",
            '\n' | '\t' => safe.push(c),
            c if c.is_control() => safe.push('\u{fffd}'),
            c => safe.push(c),
        }
    }
    safe
}

/// A cell of a table.
pub enum Cell {
    /// Words.
    Text(String),
    /// A number as it is shown, and as it sorts.
    Number(String, Option<f64>),
    /// Words that lead to another file, in a folder beside.
    Link(String, String),
    /// HTML that is made here.
    Html(String),
}

impl Cell {
    /// A number with so many decimals; a dash where there is none.
    pub fn of(value: Option<f64>, digits: usize) -> Self {
        Self::Number(crate::show::table::number(value, digits), value.filter(|v| v.is_finite()))
    }
}

impl Display for Cell {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Text(text) => write!(f, "<td>{}</td>", escaped(text)),
            Self::Number(text, value) => {
                f.write_str("<td class=\"n\"")?;
                if let Some(value) = value {
                    write!(f, " data-v=\"{value}\"")?;
                }
                write!(f, ">{}</td>", escaped(text).replace('-', "−"))
            }
            Self::Link(text, address) => {
                write!(f, "<td><a href=\"{}\">{}</a></td>", address_of(address), escaped(text))
            }
            Self::Html(html) => f.write_str(html),
        }
    }
}

/// A relative path as an address.
fn address_of(path: &str) -> String {
    let mut address = String::new();
    for byte in path.bytes() {
        if byte.is_ascii_alphanumeric() || b"-._~/".contains(&byte) {
            address.push(char::from(byte));
        } else {
            let _ = write!(address, "%{byte:02X}");
        }
    }
    address
}

/// A table; `numbers` says from which column on how many are numbers. One that sorts has buttons for it.
pub fn table(header: &[&str], numbers: (usize, usize), rows: &[Vec<Cell>], sorts: bool) -> String {
    let mut html = String::from("<div class=\"scroll\"><table");
    html += if sorts { " class=\"sortable\">\n<thead><tr>" } else { ">\n<thead><tr>" };
    for (column, name) in header.iter().enumerate() {
        let is_number = (numbers.0..numbers.0 + numbers.1).contains(&column);
        let class = if is_number { " class=\"n\"" } else { "" };
        let name = escaped(name);
        let name = if sorts { format!("<button type=\"button\">{name}</button>") } else { name };
        let _ = write!(html, "<th scope=\"col\"{class}>{name}</th>");
    }
    html += "</tr></thead>\n<tbody>\n";
    for row in rows {
        html += "<tr>";
        for cell in row {
            let _ = write!(html, "{cell}");
        }
        html += "</tr>\n";
    }
    html + "</tbody></table></div>\n"
}
