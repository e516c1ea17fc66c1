#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace fluidcarve {

/// A whole file in memory, read by lines, words or bytes. What is wrong is told with the file and, in text, the line.
class FileText {
public:
    static constexpr auto all = static_cast<std::size_t>(-1);

    /// @param most  takes no more than so many bytes, from the beginning
    /// @throws Failure (input) if this is no regular file, can't be read or is empty
    explicit FileText(std::string path, std::size_t most = all);

    const std::string& path() const { return path_; }

    /// Turns to the next line, without its end; false behind the last, and where not all of it was taken.
    bool next();
    /// Whether next() met the end of what was taken, not of the file.
    bool ran_out() const { return ran_out_; }
    std::string_view line() const { return line_; }
    /// The next word of the line, or empty. @param comment  a word that begins with it ends the line; 0: none
    std::string_view word(char comment = 0);
    /// The next word of this or a later line. @throws Failure if there is none
    std::string_view any_word();
    /// What the line holds behind the words taken from it.
    std::string_view rest_of_line();

    /// Whether words were asked for where a comment stands.
    bool has_comments() const { return has_comments_; }

    /// All that follows the current line, of what was taken.
    std::string_view rest() const { return std::string_view(text_).substr(next_); }
    /// How many bytes follow the current line in the file.
    std::size_t left() const { return size_ - next_; }
    /// Takes bytes from it. @throws Failure if there are not as many
    std::string_view take(std::size_t bytes);

    /// @throws Failure if the word is no finite number
    double number(std::string_view word) const;
    /// The same for one that may be infinite, or nan. @throws Failure if the word is no number
    double any_number(std::string_view word) const;
    /// @throws Failure if the word is no whole number
    long whole(std::string_view word) const;

    /// @throws Failure (input) with file and line
    [[noreturn]] void fault(const std::string& message) const;
    /// @throws Failure (input) with the file alone
    [[noreturn]] void fault_in_all(const std::string& message) const;

private:
    std::string path_, text_;
    std::string_view line_;
    std::size_t size_ = 0, next_ = 0, in_line_ = 0;
    int number_ = 0;
    bool ran_out_ = false, has_comments_ = false;
};

/// A word of a file as it may be shown: quoted, not too long, without what is no plain text.
std::string quoted(std::string_view word);

}  // namespace fluidcarve
