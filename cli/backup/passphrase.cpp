// SPDX-License-Identifier: Apache-2.0
#include <termios.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <istream>
#include <ostream>

#include "cli/backup/sealed.hpp"

namespace asip::cli {
namespace {

constexpr std::size_t kMinPassphrase = 8, kMaxPassphrase = 1024;
constexpr char kEndOfText = '\x03';

/// What is typed is not shown. Ctrl-C ends the line, so that the terminal is as it was whatever happens.
class Unseen {
  public:
    Unseen() : changed_(::tcgetattr(STDIN_FILENO, &before_) == 0) {
        auto unseen = before_;
        unseen.c_lflag &= ~static_cast<tcflag_t>(ECHO | ISIG);
        unseen.c_cc[VEOL] = kEndOfText;
        if (changed_) ::tcsetattr(STDIN_FILENO, TCSAFLUSH, &unseen);
    }
    ~Unseen() {
        if (changed_) ::tcsetattr(STDIN_FILENO, TCSAFLUSH, &before_);
    }
    Unseen(const Unseen&) = delete;
    Unseen& operator=(const Unseen&) = delete;

  private:
    termios before_{};
    bool changed_;
};

/// A longer one is not read to its end.
std::string first_line(std::istream& in, char* ended_by = nullptr) {
    std::string line;
    char c = 0;
    while (line.size() <= kMaxPassphrase && in.get(c) && c != '\n' &&
           (ended_by == nullptr || c != kEndOfText))
        line += c;
    if (ended_by != nullptr) *ended_by = c;
    return line;
}

Outcome<std::string> typed_line(const std::string& prompt, const Environment& environment) {
    const Unseen unseen;  // what was typed before it is lost
    environment.err << prompt << std::flush;
    char ended_by = 0;
    auto line = first_line(environment.in, &ended_by);
    environment.err << '\n' << std::flush;
    if (line.empty() || ended_by == kEndOfText) return interrupted();
    return line;
}

Outcome<std::string> passphrase_text(const std::string& file, bool made_now, const Environment& environment) {
    if (file == "-") return first_line(environment.in);
    if (!file.empty()) {
        std::ifstream in(file, std::ios::binary);
        if (!in) return failure(program::kExitFailure, file + ": " + std::strerror(errno));
        return first_line(in);
    }
    if (::isatty(STDIN_FILENO) == 0) {
        return failure(
            program::kExitUsage,
            "a passphrase is needed, and there is no terminal to ask at: --passphrase-file FILE (-: "
            "standard input)");
    }
    auto first = typed_line("Passphrase: ", environment);
    if (!first || !made_now) return first;
    const auto again = typed_line("The same again: ", environment);
    if (!again) return again;
    if (*again != *first) return failure(program::kExitUsage, "these were two passphrases");
    return first;
}

}  // namespace

Outcome<Passphrase> read_passphrase(const std::string& file, bool made_now, const Environment& environment) {
    auto text = passphrase_text(file, made_now, environment);
    if (!text) return tl::unexpected(text.error());
    if (text->size() < kMinPassphrase || text->size() > kMaxPassphrase)
        return failure(program::kExitUsage, "a passphrase has 8 to 1024 bytes");
    return Passphrase{std::move(*text), true};
}

}  // namespace asip::cli
