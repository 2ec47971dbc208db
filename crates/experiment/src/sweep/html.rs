//! The report as a self-contained page, and as the files of a web server.

/// The placeholder of the report in the page.
const PLACE: &str = "/*REPORT*/null";
const PAGE: &str = include_str!("report.html");

/// The page with the report inserted.
pub(crate) fn page(title: &str, json: &str) -> String {
    // No text in the report can end the script.
    let json = json.replace("</", "<\\/").replace("<!--", "<\\!--");
    PAGE.replace("<title></title>", &format!("<title>{title}</title>"))
        .replace(PLACE, json.trim_end())
}

/// The page as files of a server that forbids inline styles and scripts, each under its path.
/// `json` is a report. `has_games` says whether games can be watched there, at `/?game=` and their
/// index.
pub fn served(json: &serde_json::Value, has_games: bool) -> [(&'static str, String); 4] {
    let (before, _) = halves(PAGE, "<meta http-equiv");
    let (style, after) = between(PAGE, "style");
    let (data, rest) = between(after, "script");
    let (script, end) = between(rest, "script");
    let head = format!(
        "{before}<link rel=\"icon\" href=\"/icon.svg\">\n<link rel=\"stylesheet\" href=\"/sweep.css\">\n<title>Sweep</title>\n"
    );
    let (_, body) = halves(after, "</head>");
    let (body, _) = halves(body, "<script>");
    let head = head.replace(
        "<html lang=\"en\">",
        &format!("<html lang=\"en\" data-games=\"{has_games}\">"),
    );
    let scripts = "<script src=\"/sweep_report.js\"></script>\n<script src=\"/sweep.js\"></script>";
    [
        ("/sweep.html", format!("{head}</head>{body}{scripts}{end}")),
        ("/sweep.css", style.to_owned()),
        // JSON is valid JavaScript.
        ("/sweep_report.js", data.replace(PLACE, &json.to_string())),
        ("/sweep.js", script.to_owned()),
    ]
}

/// The text before a mark, and the text after it.
fn halves<'a>(text: &'a str, mark: &str) -> (&'a str, &'a str) {
    text.split_once(mark).expect("the page has it")
}

/// The content of the first element with a tag, and the text after it.
fn between<'a>(text: &'a str, tag: &str) -> (&'a str, &'a str) {
    halves(halves(text, &format!("<{tag}>")).1, &format!("</{tag}>"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_report_stands_in_the_page_once_and_cannot_end_its_script() {
        let page = page("wind", "{\"why\": \"</script><script>alert(1)</script>\"}");
        assert!(
            page.contains("<title>wind</title>")
                && page.contains("<\\/script><script>alert(1)<\\/script>")
        );
        assert!(!page.contains(PLACE) && PAGE.matches(PLACE).count() == 1);
    }

    #[test]
    fn a_server_has_style_and_scripts_apart_and_all_of_them() {
        let [(_, page), (_, style), (_, data), (_, script)] =
            served(&serde_json::json!({"sweep": "wind"}), true);
        for inside in ["<style", "<script>", "http-equiv", "style="] {
            assert!(!page.contains(inside), "{inside}");
        }
        assert!(
            page.contains("data-games=\"true\"")
                && page.contains("id=\"worst-list\"")
                && page.ends_with("</html>\n")
        );
        assert_eq!(data.trim(), "const report = {\"sweep\":\"wind\"};");
        assert!(
            style.contains(".tornado")
                && script.contains("function begin()")
                && !script.contains("</script>")
        );
    }
}
