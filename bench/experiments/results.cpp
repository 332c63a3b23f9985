// SPDX-License-Identifier: Apache-2.0
#include "bench/experiments/results.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <numeric>
#include <stdexcept>

namespace asip::experiments {
namespace {

std::string quoted(const std::string& cell) {
    if (cell.find_first_of(",\"\n") == std::string::npos) return cell;
    std::string text = "\"";
    for (const char c : cell)
        text += c == '"' ? std::string("\"\"") : std::string(1, c);
    return text + "\"";
}

void write_file(const std::filesystem::path& path, const std::string& text) {
    std::ofstream file(path);
    file << text;
    file.close();
    if (!file) throw std::runtime_error("cannot write " + path.string());
}

void print_row(const std::vector<std::string>& row, const std::vector<std::size_t>& widths) {
    std::string line;
    for (std::size_t i = 0; i < row.size(); ++i) {
        const auto& cell = row[i].empty() ? std::string("-") : row[i];
        line += i == 0 ? fmt::format("{:<{}}", cell, widths[i]) : fmt::format("  {:>{}}", cell, widths[i]);
    }
    std::printf("%s\n", line.c_str());
}

}  // namespace

void Results::print() const {
    std::vector<std::size_t> widths;
    for (std::size_t i = 0; i < columns.size(); ++i) {
        widths.push_back(std::max<std::size_t>(columns[i].size(), 1));
        for (const auto& row : rows)
            widths[i] = std::max(widths[i], row[i].size());
    }
    std::printf("\n%s\n", title.c_str());
    print_row(columns, widths);
    for (const auto& row : rows)
        print_row(row, widths);
    for (const auto& note : notes)
        std::printf("  * %s\n", note.c_str());
    std::fflush(stdout);
}

std::string Results::csv() const {
    std::string text;
    const auto add = [&](const std::vector<std::string>& row) {
        for (std::size_t i = 0; i < row.size(); ++i)
            text += (i == 0 ? "" : ",") + quoted(row[i]);
        text += "\n";
    };
    add(columns);
    for (const auto& row : rows)
        add(row);
    return text;
}

void Results::save(const std::filesystem::path& folder) const {
    write_file(folder / (name + ".csv"), csv());
    for (const auto& picture : pictures)
        write_file(folder / (name + (pictures.size() > 1 ? "-" + picture.name : "") + ".svg"), picture.svg);
}

Summary summary(std::vector<double> samples) {
    std::sort(samples.begin(), samples.end());
    const auto count = samples.size();
    return {std::accumulate(samples.begin(), samples.end(), 0.0) / static_cast<double>(count),
            samples[count / 2], samples[(count - 1) * 99 / 100], samples.back()};
}

}  // namespace asip::experiments
