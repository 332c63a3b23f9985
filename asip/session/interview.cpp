#include "asip/session/interview.hpp"

#include <array>
#include <string_view>

#include "asip/model/names.hpp"
#include "asip/protocol/error_code.hpp"
#include "asip/protocol/request.hpp"

namespace asip::session {

namespace {

constexpr std::array<std::string_view, 9> kQuestions{
    protocol::kAskInfo,      protocol::kAskExtensions,      protocol::kAskServiceNames,
    protocol::kAskPinOwners, protocol::kAskPortMap,         protocol::kAskAnalogMap,
    protocol::kAskPinModes,  protocol::kAskPinCapabilities, protocol::kAskIdentity,
};

constexpr int kTries = 3;

template <class T>
bool keep(Expected<T> parsed, T& place) {
    if (!parsed) return false;
    place = std::move(*parsed);
    return true;
}

}  // namespace

void Interview::start(std::string services, Time now, std::vector<std::string>& lines) {
    *this = Interview{};
    progress_ = Progress::kAsking;
    banner_services_ = std::move(services);
    ask(now, lines);
}

void Interview::ask(Time now, std::vector<std::string>& lines) {
    asked_ = now;
    ++tries_;
    lines.emplace_back(kQuestions[step_]);
}

bool Interview::skip_step() const {
    return kQuestions[step_] == protocol::kAskIdentity && !identity_.extensions.has(protocol::kIdentity);
}

void Interview::next(Time now, std::vector<std::string>& lines) {
    tries_ = 0;
    do {
        if (++step_ == kQuestions.size()) return finish();
    } while (skip_step());
    ask(now, lines);
}

void Interview::finish() {
    if (identity_.services.empty())
        for (char letter : banner_services_)
            if (letter >= 'A' && letter <= 'Z' && !identity_.find_service(letter))
                identity_.services.push_back({letter, {}});
    progress_ = Progress::kDone;
}

bool Interview::take(const protocol::Event& event) {
    if (event.service == 'I') {
        switch (event.tag) {
            case 'M':
                return keep(protocol::PortMap::parse(event.body), identity_.port_map);
            case 'm':
                return keep(protocol::parse_analog_map(event.body), identity_.analog_pins);
            case 'p':
                return keep(protocol::parse_pin_modes(event.body), identity_.pin_modes);
            case 'c':
                return keep(protocol::parse_pin_capabilities(event.body), identity_.pin_capabilities);
            default:
                return false;
        }
    }
    switch (event.tag) {
        case '?':
            return keep(protocol::parse_board_info(event.body), identity_.info);
        case 'X':
            return keep(protocol::parse_extensions(event.body), identity_.extensions);
        case 'N': {
            auto names = protocol::parse_service_names(event.body);
            if (!names) return false;
            for (auto& name : *names)
                if (!identity_.find_service(name.id)) identity_.services.push_back(std::move(name));
            return true;
        }
        case 'S':
            return keep(protocol::parse_pin_owners(event.body), identity_.pin_owners);
        case 'I':
            if (model::valid_board_name(event.body)) identity_.stored_name = event.body;
            return true;
        default:
            return false;
    }
}

bool Interview::on_event(const protocol::Event& event, Time now, std::vector<std::string>& lines) {
    if (progress_ != Progress::kAsking) return false;
    const std::string_view question = kQuestions[step_];
    if (event.service != question[0] || event.tag != question[2]) return false;
    // A damaged answer is asked for again at once, while tries are left.
    if (take(event)) {
        next(now, lines);
    } else if (tries_ < kTries) {
        ask(now, lines);
    } else if (step_ == 0) {
        progress_ = Progress::kFailed;
    } else {
        next(now, lines);
    }
    return true;
}

bool Interview::on_error(const protocol::ErrorReply& error, Time now, std::vector<std::string>& lines) {
    if (progress_ != Progress::kAsking) return false;
    const std::string_view question = kQuestions[step_];
    const bool ours = (error.service == question[0] && error.tag == question[2]) || error.service == 'Q' ||
                      error.tag == '?';
    if (!ours) return false;
    const bool damaged = error.code == static_cast<int>(protocol::ErrorCode::BadArgument);
    if (damaged && tries_ < kTries) {
        ask(now, lines);
    } else if (step_ == 0) {
        progress_ = Progress::kFailed;
    } else {
        next(now, lines);
    }
    return true;
}

void Interview::on_deadline(Time now, Duration answer_timeout, std::vector<std::string>& lines) {
    if (progress_ != Progress::kAsking || now < asked_ + answer_timeout) return;
    if (tries_ < kTries) {
        ask(now, lines);
    } else if (step_ == 0) {
        progress_ = Progress::kFailed;
    } else {
        next(now, lines);
    }
}

}  // namespace asip::session
