// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <streambuf>
#include <string>
#include <string_view>

namespace asip::cli {

/// A control character that asipctl itself sends to the terminal: a TerminalBuffer lets it through. A random
/// number stands before it, so that no text of a stranger can look like it.
std::string own_control(char character);

/// What both outputs of asipctl pass on their way out: no text that a board, a broker or a file brought can
/// move the cursor, colour anything or turn the direction of writing, whichever verb forgot to look at it.
/// Line ends, tabs and own_control() stay; for_terminal() says what becomes of the rest.
class TerminalBuffer : public std::streambuf {
  public:
    explicit TerminalBuffer(std::streambuf* target) : target_(target) {}
    ~TerminalBuffer() override;

  protected:
    std::streamsize xsputn(const char* text, std::streamsize size) override;
    int_type overflow(int_type character) override;
    int sync() override;

  private:
    /// Unless it is `all`, an unfinished character at the end waits for its other bytes.
    bool pass(std::string_view text, bool all);

    std::streambuf* target_;
    std::string waiting_{};
};

}  // namespace asip::cli
