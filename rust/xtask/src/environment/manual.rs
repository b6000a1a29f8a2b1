//! The manual inside the extension: the pages of `addon/docs` as HTML, for reading without a network.

use anyhow::{Context, Result};
use pulldown_cmark::{CowStr, Event, Options, Parser, Tag, TagEnd, html};
use std::collections::HashMap;
use std::path::Path;

/// Pages in the order of the contents line, with their titles there.
const PAGES: [(&str, &str); 6] = [
    ("guide", "Panels"),
    ("effects", "Models and effects"),
    ("study_format", "Study format"),
    ("grasp_data", "Grasp data"),
    ("batch_and_farms", "Batches and farms"),
    ("troubleshooting", "Troubleshooting"),
];

const STYLE: &str = "body{max-width:50rem;margin:2rem auto;padding:0 1rem;font:16px/1.5 system-ui,sans-serif;color:#222;background:#fff}\
    h1,h2,h3{line-height:1.25}h2{margin-top:2.2rem;border-bottom:1px solid #ddd}table{border-collapse:collapse;margin:1rem 0}\
    td,th{border:1px solid #ccc;padding:.3rem .6rem;text-align:left;vertical-align:top}code{background:#f2f2f2;padding:0 .2em}\
    pre{background:#f2f2f2;padding:.8rem;overflow:auto}img{max-width:100%}nav{margin-bottom:1.5rem}nav a{margin-right:1.2rem}\
    :target{background:#fff3c4}@media(prefers-color-scheme:dark){body{color:#ddd;background:#1d1d1d}code,pre{background:#2b2b2b}\
    a{color:#8ab4f8}td,th{border-color:#555}h2{border-color:#444}:target{background:#554400}}";

/// Writes a page of HTML into `to` for each page in `docs`, and copies their pictures.
///
/// # Errors
/// If a page is missing, or a file cannot be read or written.
pub fn write(docs: &Path, to: &Path) -> Result<()> {
    std::fs::create_dir_all(to.join("pictures"))
        .with_context(|| format!("cannot make {}", to.display()))?;
    for (name, title) in PAGES {
        let source = docs.join(format!("{name}.md"));
        let text = std::fs::read_to_string(&source)
            .with_context(|| format!("cannot read {}", source.display()))?;
        for picture in pictures(&text) {
            let (from, target) = (docs.join(&picture), to.join(place_of(&picture)));
            std::fs::copy(&from, &target)
                .with_context(|| format!("cannot copy {}", from.display()))?;
        }
        let target = to.join(format!("{name}.html"));
        std::fs::write(&target, page(&text, title))
            .with_context(|| format!("cannot write {}", target.display()))?;
    }
    Ok(())
}

/// A page with the line of contents above it.
fn page(markdown: &str, title: &str) -> String {
    let mut body = String::new();
    html::push_html(&mut body, events(markdown).into_iter());
    let link = |(name, title): &(&str, &str)| format!("<a href=\"{name}.html\">{title}</a>");
    let contents: Vec<String> = PAGES.iter().map(link).collect();
    format!(
        "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><meta name=\"viewport\" content=\"width=device-width\">\
         <title>Thenar: {title}</title><style>{STYLE}</style></head>\n<body><nav>{}</nav>\n{body}</body></html>\n",
        contents.concat()
    )
}

/// The page with anchors at its headings, links between pages, and without links into the repository.
fn events(markdown: &str) -> Vec<Event<'_>> {
    let mut events: Vec<Event<'_>> = Parser::new_ext(markdown, Options::ENABLE_TABLES).collect();
    let mut used: HashMap<String, usize> = HashMap::new();
    for at in 0..events.len() {
        if !matches!(events[at], Event::Start(Tag::Heading { .. })) {
            continue;
        }
        let text: String = events[at + 1..]
            .iter()
            .take_while(|e| !matches!(e, Event::End(TagEnd::Heading(_))))
            .filter_map(|e| match e {
                Event::Text(text) | Event::Code(text) => Some(text.as_ref()),
                _ => None,
            })
            .collect();
        let mut anchor = slug(&text);
        let count = used.entry(anchor.clone()).or_default();
        if *count > 0 {
            anchor = format!("{anchor}-{count}");
        }
        *count += 1;
        if let Event::Start(Tag::Heading { id, .. }) = &mut events[at] {
            *id = Some(CowStr::from(anchor));
        }
    }
    let mut leaves = Vec::new();
    events.retain_mut(|event| match event {
        Event::Start(Tag::Link { dest_url, .. }) => {
            let is_outside = dest_url.starts_with("../");
            leaves.push(is_outside);
            *dest_url = CowStr::from(linked(dest_url));
            !is_outside
        }
        Event::Start(Tag::Image { dest_url, .. }) => {
            *dest_url = CowStr::from(place_of(dest_url));
            true
        }
        Event::End(TagEnd::Link) => !leaves.pop().unwrap_or(false),
        _ => true,
    });
    events
}

/// The anchor of a heading, as forges make it: letters in lower case, blanks as hyphens, no punctuation.
fn slug(heading: &str) -> String {
    let kept = heading.trim().chars().filter_map(|c| match c {
        ' ' => Some('-'),
        '-' | '_' => Some(c),
        _ if c.is_alphanumeric() => Some(c),
        _ => None,
    });
    kept.flat_map(char::to_lowercase).collect()
}

/// A link to a page as one to its HTML.
fn linked(to: &str) -> String {
    match to.split_once(".md") {
        Some((name, rest)) if !name.contains('/') && (rest.is_empty() || rest.starts_with('#')) => {
            format!("{name}.html{rest}")
        }
        _ => to.to_string(),
    }
}

/// Where the manual holds a picture, relative to its pages.
fn place_of(picture: &str) -> String {
    let name = picture.rsplit('/').next().unwrap_or(picture);
    format!("pictures/{name}")
}

/// Pictures that a page shows, relative to it.
fn pictures(markdown: &str) -> Vec<String> {
    let all = Parser::new_ext(markdown, Options::ENABLE_TABLES);
    all.filter_map(|event| match event {
        Event::Start(Tag::Image { dest_url, .. }) => Some(dest_url.to_string()),
        _ => None,
    })
    .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn headings_get_the_anchors_that_links_ask_for() {
        let made = page(
            "# A\n\n## Hand & Grasp\n\nSee [b](#hand--grasp).\n\n## `bone`\n\n## `bone`\n",
            "T",
        );
        for wanted in [
            "id=\"hand--grasp\"",
            "href=\"#hand--grasp\"",
            "id=\"bone\"",
            "id=\"bone-1\"",
        ] {
            assert!(made.contains(wanted), "{wanted}: {made}");
        }
    }

    #[test]
    fn links_lead_to_pages_and_none_leaves_the_manual() {
        let made = page(
            "[a](effects.md#bone) [b](guide.md) [c](../../tests/X.md) <https://a.b> ![p](../x/p.png)",
            "T",
        );
        assert!(made.contains("effects.html#bone") && made.contains("href=\"guide.html\""));
        assert!(made.contains("src=\"pictures/p.png\""));
        assert!(made.contains('c') && !made.contains("../") && made.contains("https://a.b"));
    }
}
