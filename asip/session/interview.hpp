// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "asip/protocol/board_info.hpp"
#include "asip/protocol/extensions.hpp"
#include "asip/protocol/message.hpp"
#include "asip/protocol/pin.hpp"
#include "asip/protocol/port_map.hpp"
#include "asip/time.hpp"

namespace asip::session {

/// What a board answered about itself; the rest is empty, never guessed.
struct Identity {
    protocol::BoardInfo info;
    std::string stored_name;                      ///< from the identity extension; empty if it has none
    std::vector<protocol::ServiceName> services;  ///< in the board's order, one entry a letter
    protocol::Extensions extensions;              ///< empty on a 0.4 board
    std::string pin_owners;                       ///< one character a pin, or empty
    std::vector<std::uint8_t> pin_capabilities;   ///< bits of pin.hpp, or empty
    std::vector<protocol::PinMode> pin_modes;     ///< kept up to date while requests change them; or empty
    protocol::AnalogMap analog_pins;
    protocol::PortMap port_map;

    /// Null: none. Valid while `services` is not changed.
    const protocol::ServiceName* find_service(char letter) const;
};

/// Modes of pins and the line rate aside.
bool same_board(const Identity& a, const Identity& b);
/// Two boards for sure, or one with another sketch.
bool is_other_board(const Identity& a, const Identity& b);

/// Asks a board what it is: one question at a time, each up to three times. Only `#,?` must be answered.
/// Answers may come late; services and pins that did not come are asked for again in the end. A board has no
/// extensions where it refuses `#,X` twice, or twice answers `#,?` and not `#,X`.
class Interview {
  public:
    enum class Progress { kAsking, kDone, kFailed };

    /// `services`: of a banner, for boards that do not answer `#,N`. `with_checksums`: turn them on once the
    /// board is known to have them, and ask everything again. The question goes to `lines`.
    Interview(std::string services, bool with_checksums, Time now, std::vector<std::string>& lines);

    /// True: it answered our question.
    bool on_event(const protocol::Event& event, Time now, std::vector<std::string>& lines);
    bool on_error(const protocol::ErrorReply& error, Time now, std::vector<std::string>& lines);
    void on_deadline(Time now, Duration answer_timeout, std::vector<std::string>& lines);
    /// As if it had not been asked.
    void repeat(Time now, std::vector<std::string>& lines);

    Progress progress() const { return progress_; }
    Time next_deadline(Duration answer_timeout) const { return asked_ + answer_timeout; }
    Identity& identity() { return identity_; }
    /// When done: a question besides `#,?` that the board answered, preferably `#,N`.
    std::string other_question() const;

  private:
    static constexpr std::size_t kQuestionCount = 9;
    void ask(Time now, std::vector<std::string>& lines);
    void ask_again_or_pass(Time now, std::vector<std::string>& lines);
    void pass(bool refused, Time now, std::vector<std::string>& lines);
    void start_again(Time now, std::vector<std::string>& lines);
    void next(Time now, std::vector<std::string>& lines);
    bool skip_step() const;
    bool take_late(const protocol::Event& event);
    void note_answer(std::size_t step);
    bool take(const protocol::Event& event);
    bool take_extensions(std::string_view body);
    bool take_of_core(const protocol::Event& event);
    void finish();

    Progress progress_ = Progress::kAsking;
    std::size_t step_ = 0;
    int tries_ = 0;
    int tries_at_once_ = 0;
    int rounds_ = 0;
    int refusals_ = 0;
    std::array<bool, kQuestionCount> unanswered_{};  // by step: asked, and neither answered nor refused
    bool once_more_ = false;
    protocol::Extensions extensions_;  // as last answered
    Time asked_{};
    bool turn_checksums_on_;
    std::string banner_services_;
    std::string other_question_;
    Identity identity_;
};

}  // namespace asip::session
