// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace asip::cli {

/// A line that is edited on the terminal (standard input and output), by libedit. While it waits for keys the
/// owner goes on with its own work, and may show lines above the one that is edited.
class LineEditor {
  public:
    struct Hooks {
        /// What stands before the line.
        std::function<std::string()> prompt;
        /// One line above it, at most `columns` wide; empty: none.
        std::function<std::string(std::size_t columns)> status;
        /// What the last word of `typed`, the line up to the cursor, may become; or kOfferFiles or
        /// kOfferFolders.
        std::function<std::vector<std::string>(const std::string& typed)> complete;
        /// Works until `ready` holds; false: the shell ends.
        std::function<bool(const std::function<bool()>& ready)> wait;
    };

    explicit LineEditor(Hooks hooks);
    ~LineEditor();
    LineEditor(const LineEditor&) = delete;
    LineEditor& operator=(const LineEditor&) = delete;

    /// One line, without its end. Ctrl-C leaves the line and begins a new one. Nothing: Ctrl-D on an empty
    /// line, the terminal is gone, or wait() said so.
    std::optional<std::string> read();
    /// For Ctrl-R and the arrow keys.
    void remember(const std::string& line);

    /// Shows `text` and the newest status above the line that is edited, which stays as it is. Outside of
    /// read(), `text` is just printed.
    void show_above(const std::string& text);
    void show_status();

  private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace asip::cli
