#pragma once

#include "carve/base/numbers.h"
#include "formats/file/input_file.h"

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace fluidcarve {

/// Reads a file by lines, words or bytes. Faults name the file and, in text, the line.
class FileText {
public:
    static constexpr auto all = static_cast<std::size_t>(-1);

    /// Reads a file without its byte order mark, if it has one of UTF-8.
    /// @param most  reads only so many bytes from the beginning
    /// @throws Unreadable if the file can't be read; Failure (input) if it is in UTF-16
    explicit FileText(const InputFile& file, std::size_t most = all);

    const std::string& path() const { return path_; }

    /// Moves to the next line. False after the last line, or if the next line was not read
    /// completely (`most`).
    bool next();
    /// The cells of the next line of a table that has any, separated by commas, semicolons or
    /// blanks, without quotes and without text behind a #. Empty: there is none.
    std::vector<std::string_view> next_cells();
    /// Whether next() met the end of the bytes read, but not of the file.
    bool ran_out() const { return ran_out_; }
    std::string_view line() const { return line_; }
    /// Number of the line, from 1; 0 before the first.
    int line_number() const { return number_; }
    /// Whether a line end follows the line; the last line may have none.
    bool line_ends() const { return next_ > 0 && text_[next_ - 1] == '\n'; }
    /// The next word of the line, or empty.
    /// @param comment  a word that begins with this character ends the line; 0: none
    std::string_view word(char comment = 0);
    /// The next word of this or a later line. @throws Failure if there is none
    std::string_view any_word();
    /// The rest of the line after the words taken from it.
    std::string_view rest_of_line();

    /// Whether word() has met a comment.
    bool has_comments() const { return has_comments_; }

    /// The bytes read after the current line.
    std::string_view rest() const { return std::string_view(text_).substr(next_); }
    /// Number of bytes in the file after the current line.
    std::size_t left() const { return size_ - next_; }
    /// Takes the next bytes of rest(). @throws Failure if there are not enough
    std::string_view take(std::size_t bytes);

    /// @throws Failure if the word is not a finite number
    double number(std::string_view word) const;
    /// The same, but accepts inf and nan. @throws Failure if the word is not a number
    double any_number(std::string_view word) const;
    /// @throws Failure if the word is not a whole number
    long whole_number(std::string_view word) const;

    /// @throws Failure (input) naming file and line
    [[noreturn]] void fault(const std::string& message) const { fault_at(number_, message); }
    [[noreturn]] void fault_at(int line, const std::string& message) const;
    /// @throws Failure (input) naming only the file
    [[noreturn]] void fault_in_all(const std::string& message) const;

private:
    std::string path_, text_;
    std::string_view line_;
    std::size_t size_ = 0, next_ = 0, in_line_ = 0;
    int number_ = 0;
    bool ran_out_ = false, has_comments_ = false;
};

constexpr std::string_view blanks = " \t\r\v\f";

/// The words of a line. @param separators  characters between words
std::vector<std::string_view> words_of(std::string_view line, std::string_view separators = blanks);

/// A word of a file for messages: in quotes, at most 40 characters, with `?` for all but printable
/// ASCII.
std::string quoted(std::string_view word);

}  // namespace fluidcarve
