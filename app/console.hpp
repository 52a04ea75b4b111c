// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <iosfwd>
#include <string>
#include <string_view>
#include <vector>

/// What people read: tables, numbers, progress and the error line.
namespace lodestar::app {

/// `text` on one line with control characters as '?': names in a file must not steer a terminal.
std::string printable(std::string_view text);

/// Writes `lodestar: error: MESSAGE` to standard error, always one line.
void printError(std::string_view message);

std::string formatCount(std::uint64_t count);  ///< 1234567 → "1,234,567"
std::string formatBytes(std::uint64_t bytes);  ///< 1536 → "1.5 KiB"
std::string formatMs(double ms);               ///< "0.42 ms", "12.3 ms", "180 ms"

/// A table in plain text: columns as wide as their widest cell, two spaces apart, no rules.
class Table {
public:
    enum class Align { left, right };
    struct Column {
        std::string heading;
        Align align = Align::left;
    };

    explicit Table(std::vector<Column>);
    /// Throws std::invalid_argument when the number of cells is not the number of columns.
    void row(std::vector<std::string> cells);
    /// Every line starts with `indent` spaces and ends with a newline. The line of headings is left
    /// out when all are empty.
    std::string text(int indent = 2) const;

private:
    std::vector<Column> columns;
    std::vector<std::vector<std::string>> rows;
};

/// Where progress is shown.
struct Terminal {
    std::ostream* out = nullptr;
    bool interactive = false;         ///< nothing is ever written when false
    std::function<double()> seconds;  ///< a clock
};

/// Standard error; interactive only when both it and standard output are terminals, so that a run
/// whose output is piped stays quiet.
Terminal standardTerminal();

/// One line, `label [####----] done/total  time left`, redrawn in place once the work has taken a
/// second, and erased at the end.
class Progress {
public:
    Progress(std::string label, std::size_t total, Terminal = standardTerminal());
    ~Progress();
    Progress(const Progress&) = delete;
    Progress& operator=(const Progress&) = delete;

    /// `done` of `total` are finished. Cheap to call often.
    void update(std::size_t done);
    void erase();

private:
    std::string label;
    std::size_t total;
    Terminal terminal;
    double started = 0, drawn = 0;
    bool visible = false;
};

}  // namespace lodestar::app
