//! The report as one page that needs no network.

/// Where the report stands in the page.
const PLACE: &str = "/*REPORT*/null";
const PAGE: &str = include_str!("report.html");

/// The page with a report in it.
pub(crate) fn page(title: &str, json: &str) -> String {
    // Nothing in a text of the report ends the script.
    let json = json.replace("</", "<\\/").replace("<!--", "<\\!--");
    PAGE.replace("<title></title>", &format!("<title>{title}</title>")).replace(PLACE, json.trim_end())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_report_stands_in_the_page_once_and_cannot_end_its_script() {
        let page = page("wind", "{\"why\": \"</script><script>alert(1)</script>\"}");
        assert!(page.contains("<title>wind</title>") && page.contains("<\\/script><script>alert(1)<\\/script>"));
        assert!(!page.contains(PLACE) && PAGE.matches(PLACE).count() == 1);
    }
}
