// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <chrono>
#include <cstddef>
#include <functional>
#include <iosfwd>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "asip/bus/topics.hpp"
#include "asip/expected.hpp"
#include "asip/model/model_set.hpp"
#include "asip/mqtt/options.hpp"
#include "asip/program/exit_status.hpp"
#include "asip/program/options.hpp"

namespace asip::cli {

/// Why a command ends early: the text for standard error (with what to do next), and the exit status.
struct Failure {
    int status = program::kExitFailure;
    std::string text;
    std::string reason{};  ///< the word for programs of an agent's refusal: "not-there", "queue-full"
    int code = 0;          ///< of a board's error
};

template <class T>
using Outcome = Expected<T, Failure>;

inline tl::unexpected<Failure> failure(int status, std::string text) {
    return tl::unexpected<Failure>(Failure{status, std::move(text)});
}

/// Ctrl-C, or the end of the program that reads the output, while something was asked or looked for:
/// nothing is known of it.
constexpr std::string_view kInterrupted = "interrupted";
inline tl::unexpected<Failure> interrupted() {
    return failure(program::kExitFailure, std::string(kInterrupted));
}

/// Everything a command uses of the world outside its own options.
struct Environment {
    std::istream& in;
    std::ostream& out;  ///< data
    std::ostream& err;  ///< diagnostics

    std::size_t width = 0;    ///< columns of the terminal that `out` is; 0: it is none
    bool colour = false;      ///< use colours on `out`
    int out_descriptor = -1;  ///< file descriptor behind `out`; -1: none

    mqtt::Options mqtt{};
    bus::Topics topics{};
    std::optional<model::ModelSet> own_models{};  ///< standard ones and those of --services
    /// How long to wait for one answer: of the broker, a registry, a board.
    std::chrono::milliseconds timeout{5000};
    bool from_bus = false;  ///< do not ask a registry

    /// The options of every command that were typed, with their values.
    std::vector<std::pair<std::string, std::string>> typed_options{};

    /// Service models; the standard ones are read when first asked for, which `asipctl list` never does.
    const model::ModelSet& models() const { return own_models ? *own_models : model::ModelSet::standard(); }
    /// What `asipctl VERB --help` prints (without a verb: `asipctl --help`), or the nearest verb.
    std::function<Outcome<std::string>(const std::string& verb)> help{};

    bool terminal() const { return width != 0; }
    /// Whether the reader of the pipe that `out` is has gone.
    bool reader_gone() const;
    /// Whether printing more is of no use: the reader has gone, or writing failed.
    bool output_ended() const;
    /// One line for people: a line end within `text` makes no second one.
    void say(const std::string& text) const;
    /// `asipctl: TEXT` on standard error.
    void note(const std::string& text) const;
    /// The same, and the status to end with. A reader that has stopped reading is not told so.
    int fail_with(const Failure& failure) const;
};

}  // namespace asip::cli
