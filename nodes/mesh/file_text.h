#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace fluidcarve {

/// A whole file in memory, read by lines, words or bytes. What is wrong is told with the file and, in text, the line.
class FileText {
public:
    /// @throws Failure (input) if the file can't be read or is empty
    explicit FileText(std::string path);

    const std::string& path() const { return path_; }

    /// Turns to the next line, without its end; false behind the last.
    bool next();
    std::string_view line() const { return line_; }
    /// The next word of the line, or empty. @param comment  a word that begins with it ends the line; 0: none
    std::string_view word(char comment = 0);
    /// The next word of this or a later line. @throws Failure if there is none
    std::string_view any_word();
    /// What the line holds behind the words taken from it.
    std::string_view rest_of_line();

    /// All that follows the current line.
    std::string_view rest() const { return std::string_view(text_).substr(next_); }
    /// Takes bytes from it. @throws Failure if there are not as many
    std::string_view take(std::size_t bytes);

    /// @throws Failure if the word is no finite number
    double number(std::string_view word) const;
    /// @throws Failure if the word is no whole number
    long whole(std::string_view word) const;

    /// @throws Failure (input) with file and line
    [[noreturn]] void fault(const std::string& message) const;
    /// @throws Failure (input) with the file alone
    [[noreturn]] void fault_in_all(const std::string& message) const;

private:
    std::string path_, text_;
    std::string_view line_;
    std::size_t next_ = 0, in_line_ = 0;
    int number_ = 0;
};

/// A word of a file as it may be shown: quoted, not too long, without what is no plain text.
std::string quoted(std::string_view word);

}  // namespace fluidcarve
