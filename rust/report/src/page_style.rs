//! The look of every report: the style sheet, and the frame of a page.

use crate::svg::escaped;

const STYLE: &str = "\
:root{color-scheme:light}\
body{font:15px/1.5 'Inter','Source Sans 3','Segoe UI',Roboto,'Helvetica Neue',Arial,sans-serif;color:#1c2126;background:#fff;max-width:1000px;margin:2.2em auto;padding:0 1.4em}\
h1{font-size:1.75em;line-height:1.2;margin:0 0 .3em;font-weight:650;letter-spacing:-.01em}\
h2{font-size:1.3em;margin:2.2em 0 .3em;padding-top:.7em;border-top:2px solid #1c2126;font-weight:620}\
h3{font-size:1em;margin:1.5em 0 .35em;font-weight:620}\
.lead{font-size:1.16em;line-height:1.45;background:#f3f6f8;border-left:5px solid #0072b2;padding:.7em 1em;margin:.8em 0 1.4em}\
.sentence{font-size:1.06em;margin:.2em 0}\
.meta{color:#5c6770;font-size:.88em;margin:.1em 0 1em}\
.maker{color:#5c6770;font-size:.88em;margin:0 0 .4em;letter-spacing:.02em}\
table{border-collapse:collapse;width:100%;font-size:.88em;font-variant-numeric:tabular-nums;margin:.4em 0 1em}\
th{font-weight:600;text-align:right;border-bottom:1.5px solid #5c6770;padding:.3em .55em;vertical-align:bottom}\
td{text-align:right;border-bottom:1px solid #e1e6ea;padding:.28em .55em;vertical-align:middle}\
.left{text-align:left}\
code{font:.95em ui-monospace,'SF Mono',Consolas,'DejaVu Sans Mono',monospace}\
.flag{color:#b04a00;font-size:.88em}\
a{color:#005a8c}\
figure{margin:0}svg{max-width:100%;height:auto;display:block}\
.pair{display:flex;flex-wrap:wrap;gap:14px;margin:.9em 0}\
.small{display:flex;flex-wrap:wrap;gap:10px;margin:.4em 0}\
.group td{border-bottom:1.5px solid #b9c2c9;font-weight:600;padding-top:.8em}\
.map{margin:1.1em 0}figcaption{color:#5c6770;font-size:.88em;margin-top:.1em}\
ol,ul{margin:.3em 0;padding-left:1.25em}li{margin:.22em 0}\
@media print{body{max-width:none;margin:0;padding:0;font-size:11px}figure,table,.lead,.pair>*,.small>*{break-inside:avoid}.pair,.small{display:block}.pair>*,.small>*{display:inline-block;width:48%;margin:0 1% 10px 0;vertical-align:top}h2,h3{break-after:avoid}a{color:inherit;text-decoration:none}@page{size:A4;margin:14mm}}";

/// A self-contained page, UTF-8, of a title (escaped), a first sentence (as it is) and a body of HTML.
pub fn framed(title: &str, sentence: &str, body: &str) -> String {
    format!(
        "<!DOCTYPE html>\n<html lang='en'><head><meta charset='utf-8'>\
<meta name='viewport' content='width=device-width, initial-scale=1'>\
<meta name='generator' content='Thenar {}'><title>{title}</title>\n<style>{STYLE}</style></head>\n<body>\n\
<header><p class='maker'>Thenar \u{00b7} recordings beside simulation</p><h1>{title}</h1>\n\
<p class='lead'>{}</p></header>\n{body}</body></html>\n",
        env!("CARGO_PKG_VERSION"),
        escaped(sentence),
    )
}
