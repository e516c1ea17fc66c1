#include "runtime/html/html_parts.h"

#include "graph/text/base64.h"
#include "graph/text/xml_text.h"
#include "runtime/html/html_style.h"

#include <fmt/format.h>

#include <cstddef>

namespace fluidcarve {

std::string element(const std::string& open, const std::string& words) {
    return fmt::format("<{}>{}</{}>", open, xml_text(words), open.substr(0, open.find(' ')));
}

std::string wide_table(const std::vector<std::string>& heads,
                       const std::vector<std::vector<std::string>>& rows) {
    std::string out = "<div class=\"scroll\"><table class=\"wide\"><thead><tr>";
    for (std::size_t n = 0; n < heads.size(); ++n)
        out += element(n == 0 ? "th" : "th class=\"number\"", heads[n]);
    out += "</tr></thead><tbody>\n";
    for (const auto& row : rows) {
        out += "<tr>";
        for (std::size_t n = 0; n < row.size(); ++n)
            out += element(n == 0 ? "th" : "td class=\"number\"", row[n]);
        out += "</tr>\n";
    }
    return out + "</tbody></table></div>\n";
}

std::string page_begin(const std::string& title) {
    return "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
           "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
           "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; style-src "
           "'unsafe-inline'; img-src data:\">\n" +
           element("title", title + " – fluidcarve") + "\n<style>" + html_style +
           "</style>\n</head>\n<body>\n";
}

std::string picture_figure(const std::string& caption, const std::string& png) {
    return fmt::format(
        "<figure><label class=\"picture\"><input type=\"checkbox\" aria-label=\"full size\"><span "
        "class=\"scroll\"><img alt=\"{}\" "
        "src=\"data:image/png;base64,{}\"></span></label>{}</figure>\n",
        xml_text(caption), base64(png), element("figcaption", caption));
}

}  // namespace fluidcarve
