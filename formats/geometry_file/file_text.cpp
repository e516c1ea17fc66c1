#include "formats/geometry_file/file_text.h"

#include "carve/base/failure.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace fluidcarve {

FileText::FileText(const InputFile& file, std::size_t most)
    : path_(file.path()),
      text_(file.size() > most ? file.head(most) : file.whole()),
      size_(file.size()) {
    using namespace std::literals;
    for (const auto mark : {"\xff\xfe"sv, "\xfe\xff"sv})
        if (text_.starts_with(mark)) fault_in_all("the text is in UTF-16: save it in UTF-8");
    if (constexpr auto mark = "\xef\xbb\xbf"sv; text_.starts_with(mark)) next_ = mark.size();
}

bool FileText::next() {
    const auto found = text_.find('\n', next_);
    ran_out_ = found == std::string::npos && text_.size() < size_;
    if (next_ >= text_.size() || ran_out_) return false;
    const auto end = std::min(found, text_.size());
    line_ = std::string_view(text_).substr(next_, end - next_);
    if (line_.ends_with('\r')) line_.remove_suffix(1);
    next_ = std::min(end + 1, text_.size());
    in_line_ = 0;
    ++number_;
    return true;
}

std::vector<std::string_view> FileText::next_cells() {
    while (next())
        if (auto cells = words_of(line_.substr(0, line_.find('#')), ",;\" \t\r"); !cells.empty())
            return cells;
    return {};
}

std::string_view FileText::word(char comment) {
    const auto begin = std::min(line_.find_first_not_of(blanks, in_line_), line_.size());
    if (begin == line_.size() || (comment != 0 && line_[begin] == comment)) {
        has_comments_ = has_comments_ || begin != line_.size();
        in_line_ = line_.size();
        return {};
    }
    in_line_ = std::min(line_.find_first_of(blanks, begin), line_.size());
    return line_.substr(begin, in_line_ - begin);
}

std::string_view FileText::any_word() {
    for (;;) {
        if (const auto found = word(); !found.empty()) return found;
        if (!next()) fault("the file ends too early");
    }
}

std::string_view FileText::rest_of_line() {
    const auto begin = std::min(line_.find_first_not_of(blanks, in_line_), line_.size());
    in_line_ = line_.size();
    return line_.substr(begin);
}

std::string_view FileText::take(std::size_t bytes) {
    if (bytes > text_.size() - next_)
        fault_in_all("the file ends too early: it is cut off or damaged");
    const auto out = std::string_view(text_).substr(next_, bytes);
    next_ += bytes;
    return out;
}

double FileText::number(std::string_view word) const {
    const double out = any_number(word);
    if (!std::isfinite(out)) fault(fmt::format("{} is no number", quoted(word)));
    return out;
}

double FileText::any_number(std::string_view word) const {
    const auto out = number_of_word<double>(word);
    if (!out) fault(fmt::format("{} is no number", quoted(word)));
    return *out;
}

long FileText::whole_number(std::string_view word) const {
    const auto out = number_of_word<long>(word);
    if (!out) fault(fmt::format("{} is no whole number", quoted(word)));
    return *out;
}

void FileText::fault_at(int line, const std::string& message) const {
    throw Failure(fmt::format("{}:{}: {}", path_, line, message), Failure::Kind::input);
}

void FileText::fault_in_all(const std::string& message) const {
    throw Failure(fmt::format("{}: {}", path_, message), Failure::Kind::input);
}

std::vector<std::string_view> words_of(std::string_view line, std::string_view separators) {
    std::vector<std::string_view> out;
    for (std::size_t begin = 0;
         (begin = line.find_first_not_of(separators, begin)) != std::string_view::npos;) {
        const auto end = std::min(line.find_first_of(separators, begin), line.size());
        out.push_back(line.substr(begin, end - begin));
        begin = end;
    }
    return out;
}

std::string quoted(std::string_view word) {
    std::string out = "'";
    for (const char letter : word.substr(0, 40))
        out += letter >= ' ' && letter <= '~' ? letter : '?';
    return out + "'";
}

}  // namespace fluidcarve
