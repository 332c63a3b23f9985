// SPDX-License-Identifier: Apache-2.0
#include "tests/truth/command.hpp"

#include <fmt/format.h>

#include <string_view>

namespace truth {

namespace {

constexpr unsigned kDigitalPins[] = {2, 4, 7, 12, 13};
constexpr unsigned kPwmPins[] = {3, 5, 6, 9, 10, 11};

// As the board's hardware sees the modes of the protocol.
int hardware_mode(unsigned mode) {
    return mode == 2 ? 2 : mode == 3 || mode == 5 ? 3 : 1;
}

}  // namespace

Command CommandSource::draw(unsigned client, const ClientPlan& plan) {
    Command command;
    const auto kind = dice_.below(10);
    if (plan.only_marks)
        command = mark(static_cast<std::size_t>(dice_.chance(plan.longs) ? dice_.between(30, 62) : 0));
    else if (dice_.chance(plan.bad))
        command = bad();
    else if (dice_.chance(plan.longs))
        command = mark(static_cast<std::size_t>(dice_.between(30, 62)));
    else if (kind < 4)
        command = mark(0);
    else if (kind < 7)
        command = pin();
    else if (kind < 9 || !plan.settings)
        command = question();
    else
        command = setting();
    command.client = client;
    command.prove = !dice_.chance(0.1);
    switch (dice_.below(4)) {
        case 0:
            command.lasts = dice_.between(50, 400) * kMillisecond;
            break;
        case 1:
            command.lasts = dice_.between(400, 2000) * kMillisecond;
            break;
        default:
            command.lasts = 5 * kSecond;
    }
    return command;
}

Command CommandSource::bad() {
    constexpr const char* kBad[] = {"I,d,99,1", "I,d,2",   "I,d,2,x",   "I,d,2,2", "I,a,3",      "I,a,2,10",
                                    "I,P,2,9",  "I,P,0,3", "Q,x,1",     "Z,?",     "D,Q",        "S,W,0,90",
                                    "#,Z",      "W,w",     "W,w,99999", "W,q,1",   "D,M,1",      "I,zzz",
                                    "T,P,1,2",  "D,A,x",   "I,A,70000", "#,E,?!",  "#,I,no/name"};
    Command command;
    command.line = dice_.one_of(kBad);
    return command;
}

Command CommandSource::mark(std::size_t length) {
    Command command;
    command.line = fmt::format("W,w,{}", ++next_mark_);
    command.effect = Effect{Effect::Kind::kMark, 0, next_mark_};
    if (command.line.size() + 2 > length) return command;
    command.line += ',';
    while (command.line.size() < length)
        command.line += static_cast<char>(dice_.between('a', 'z'));
    return command;
}

Command CommandSource::pin() {
    Command command;
    if (dice_.chance(0.6)) {
        const unsigned pin = dice_.one_of(kDigitalPins);
        const int level = static_cast<int>(dice_.below(2));
        command.line = fmt::format("I,d,{},{}", pin, level);
        command.effect = Effect{Effect::Kind::kLevel, pin, level};
    } else {
        const unsigned pin = dice_.one_of(kPwmPins);
        const int duty = static_cast<int>(dice_.below(256));
        command.line = fmt::format("I,a,{},{}", pin, duty);
        command.effect = Effect{Effect::Kind::kDuty, pin, duty};
    }
    return command;
}

Command CommandSource::question() {
    constexpr std::string_view kQuestions[] = {"D,M", "D,M", "D,M", "I,M", "I,m",     "I,p",
                                               "I,c", "#,N", "#,S", "#,?", "#,E,mine"};
    Command command;
    command.line = dice_.one_of(kQuestions);
    command.answer_tag = command.line == "D,M" ? 'e' : command.line[2];
    if (command.line != "D,M" && dice_.chance(0.1)) command.answer_tag = 0;
    return command;
}

Command CommandSource::setting() {
    Command command;
    switch (dice_.below(8)) {
        case 0:
            command.line = "#,R";
            break;
        case 1:
        case 2:
            command.line = fmt::format("D,A,{}", dice_.chance(0.4) ? 0 : dice_.between(30, 300));
            break;
        case 3:
            command.line = fmt::format("I,A,{}", dice_.chance(0.4) ? 0 : dice_.between(30, 300));
            break;
        default: {
            constexpr unsigned kModes[] = {1, 2, 3, 5, 5, 5};
            const unsigned pin = dice_.one_of(kPwmPins);
            const unsigned mode = dice_.one_of(kModes);
            command.line = fmt::format("I,P,{},{}", pin, mode);
            command.effect = Effect{Effect::Kind::kMode, pin, hardware_mode(mode)};
        }
    }
    return command;
}

}  // namespace truth
