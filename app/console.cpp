// SPDX-License-Identifier: Apache-2.0
#include "app/console.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <iostream>
#include <stdexcept>

#include <fmt/format.h>

#ifdef _WIN32
#include <io.h>
#else
#include <unistd.h>
#endif

namespace lodestar::app {

namespace {

bool isTerminal(std::FILE* file) {
#ifdef _WIN32
    return _isatty(_fileno(file)) != 0;
#else
    return isatty(fileno(file)) != 0;
#endif
}

/// Characters rather than bytes, for UTF-8 text without wide or combining characters.
std::size_t displayWidth(std::string_view text) {
    return std::size_t(std::count_if(text.begin(), text.end(), [](char c) {
        return (static_cast<unsigned char>(c) & 0xc0) != 0x80;
    }));
}

}  // namespace

std::string printable(std::string_view text) {
    std::string result(text);
    for (std::size_t i = 0; i < result.size(); ++i) {
        const auto byte = static_cast<unsigned char>(result[i]);
        if (byte == '\n' || byte == '\t')
            result[i] = ' ';
        else if (byte < 0x20 || byte == 0x7f)
            result[i] = '?';
        // U+0080 … U+009F, C2 80 … C2 9F in UTF-8, are control characters too.
        else if (byte == 0xc2 && i + 1 < result.size() &&
                 static_cast<unsigned char>(result[i + 1]) < 0xa0)
            result.replace(i, 2, "?");
    }
    return result;
}

void printError(std::string_view message) {
    std::cout.flush();
    std::cerr << "lodestar: error: " << printable(message) << std::endl;
}

std::string formatCount(std::uint64_t count) {
    std::string digits = std::to_string(count);
    for (std::size_t i = digits.size(); i > 3; i -= 3) digits.insert(i - 3, 1, ',');
    return digits;
}

std::string formatBytes(std::uint64_t bytes) {
    if (bytes < 1024) return fmt::format("{} B", bytes);
    double value = double(bytes);
    for (const char* unit : {"KiB", "MiB", "GiB"}) {
        value /= 1024;
        if (value < 1023.95) return fmt::format("{:.1f} {}", value, unit);
    }
    return fmt::format("{:.1f} TiB", value / 1024);
}

std::string formatMs(double ms) {
    if (!std::isfinite(ms)) return "–";
    const int decimals = std::abs(ms) < 9.995 ? 2 : std::abs(ms) < 99.95 ? 1 : 0;
    return fmt::format("{:.{}f} ms", ms, decimals);
}

Table::Table(std::vector<Column> given) : columns(std::move(given)) {}

void Table::row(std::vector<std::string> cells) {
    if (cells.size() != columns.size())
        throw std::invalid_argument("Table::row: as many cells as columns are needed");
    rows.push_back(std::move(cells));
}

std::string Table::text(int indent) const {
    std::vector<std::vector<std::string>> lines = rows;
    if (std::any_of(columns.begin(), columns.end(),
                    [](const Column& column) { return !column.heading.empty(); })) {
        std::vector<std::string> headings;
        for (const Column& column : columns) headings.push_back(column.heading);
        lines.insert(lines.begin(), std::move(headings));
    }
    std::vector<std::size_t> widths(columns.size(), 0);
    for (const auto& line : lines)
        for (std::size_t i = 0; i < line.size(); ++i)
            widths[i] = std::max(widths[i], displayWidth(line[i]));

    std::string result;
    for (const auto& line : lines) {
        std::string written(std::size_t(indent), ' ');
        for (std::size_t i = 0; i < line.size(); ++i) {
            const std::string padding(widths[i] - displayWidth(line[i]), ' ');
            if (i > 0) written += "  ";
            written += columns[i].align == Align::left ? line[i] + padding : padding + line[i];
        }
        written.erase(written.find_last_not_of(' ') + 1);
        result += written + '\n';
    }
    return result;
}

Terminal standardTerminal() {
    return {
        .out = &std::cerr, .interactive = isTerminal(stdout) && isTerminal(stderr), .seconds = [] {
            const auto now = std::chrono::steady_clock::now().time_since_epoch();
            return std::chrono::duration<double>(now).count();
        }};
}

Progress::Progress(std::string givenLabel, std::size_t givenTotal, Terminal givenTerminal)
    : label(std::move(givenLabel)), total(givenTotal), terminal(std::move(givenTerminal)) {
    if (terminal.interactive) started = terminal.seconds();
}

Progress::~Progress() {
    erase();
}

void Progress::update(std::size_t done) {
    constexpr double kPatience = 1.0, kRedraw = 0.1;  // seconds
    constexpr std::size_t kCells = 30;
    if (!terminal.interactive || total == 0) return;
    const double now = terminal.seconds(), elapsed = now - started;
    if (elapsed < kPatience || (visible && now - drawn < kRedraw)) return;

    done = std::min(done, total);
    const std::size_t full = kCells * done / total;
    std::string line =
        fmt::format("\r{} [{:#<{}}{:-<{}}] {}/{}", label, "", full, "", kCells - full, done, total);
    if (done > 0) {
        const auto left = long(std::ceil(elapsed * double(total - done) / double(done)));
        line += fmt::format("  {}:{:02} left", left / 60, left % 60);
    }
    *terminal.out << line << "\x1b[K" << std::flush;
    drawn = now;
    visible = true;
}

void Progress::erase() {
    if (visible) *terminal.out << "\r\x1b[K" << std::flush;
    visible = false;
}

}  // namespace lodestar::app
