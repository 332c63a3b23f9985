// SPDX-License-Identifier: Apache-2.0
#include "asip/bus/registry/label_selector.hpp"

#include <algorithm>

#include "asip/model/labels.hpp"
#include "asip/text/printable.hpp"

namespace asip::bus {
namespace {

std::string_view trimmed(std::string_view text) {
    const auto first = text.find_first_not_of(' ');
    if (first == std::string_view::npos) return {};
    return text.substr(first, text.find_last_not_of(' ') - first + 1);
}

/// Where the term that begins at `at` ends: the next comma outside quotes.
std::size_t end_of_term(std::string_view text, std::size_t at) {
    bool quoted = false;
    for (; at < text.size() && (quoted || text[at] != ','); ++at) {
        if (text[at] == '"') quoted = !quoted;
        if (quoted && text[at] == '\\') ++at;
    }
    return std::min(at, text.size());
}

Expected<std::string> read_value(std::string_view text) {
    if (!text.starts_with('"')) return std::string(text);
    std::string value;
    std::size_t at = 1;
    for (; at < text.size() && text[at] != '"'; ++at) {
        if (text[at] == '\\' && at + 1 < text.size()) ++at;
        value += text[at];
    }
    if (at + 1 != text.size())
        return fail(text::printable(text) + (at < text.size() ? ": a comma is missing behind the quote"
                                                              : ": a quote is never closed"));
    return value;
}

std::string value_text(const std::string& value) {
    if (value.find_first_of(",\"\\") == std::string::npos) return value;
    std::string text = "\"";
    for (const char c : value) {
        if (c == '"' || c == '\\') text += '\\';
        text += c;
    }
    return text + "\"";
}

}  // namespace

Expected<LabelSelector::Term> LabelSelector::parse_term(std::string_view text) {
    constexpr const char* kForms = "; write KEY=VALUE, KEY!=VALUE, KEY or !KEY";
    Term term;
    auto key = trimmed(text);
    if (const auto equals = key.find('='); equals != std::string_view::npos) {
        auto value = read_value(trimmed(key.substr(equals + (key.substr(equals).starts_with("==") ? 2 : 1))));
        if (!value) return fail(value.error());
        term.kind = Term::Kind::kIs;
        term.value = std::move(*value);
        key = key.substr(0, equals);
        if (key.ends_with('!')) {
            term.kind = Term::Kind::kIsNot;
            key.remove_suffix(1);
        }
        key = trimmed(key);
        if (const auto why = model::explain_label_value(term.value); !why.empty())
            return fail("the value of " + text::printable(key) + " " + why);
    } else if (key.starts_with('!')) {
        term.kind = Term::Kind::kHasNot;
        key = trimmed(key.substr(1));
    }
    const auto why = trimmed(text).empty() ? "a term is empty" : model::explain_label_key(key);
    if (!why.empty()) return fail(why + kForms);
    term.key = key;
    return term;
}

Expected<LabelSelector> LabelSelector::parse(std::string_view text) {
    if (text.size() > kMaxBytes) return fail("is longer than " + std::to_string(kMaxBytes) + " bytes");
    if (trimmed(text).empty())
        return fail("is empty: it would choose every board; write for example room=lab");
    LabelSelector selector;
    for (std::size_t at = 0; at <= text.size();) {
        const auto end = end_of_term(text, at);
        auto term = parse_term(text.substr(at, end - at));
        if (!term) return fail(term.error());
        if (selector.terms_.size() == kMaxTerms)
            return fail("has more than " + std::to_string(kMaxTerms) + " terms");
        selector.terms_.push_back(std::move(*term));
        at = end + 1;
    }
    return selector;
}

bool LabelSelector::matches(const std::map<std::string, std::string>& labels) const {
    return std::all_of(terms_.begin(), terms_.end(), [&labels](const Term& term) {
        const auto found = labels.find(term.key);
        const bool has = found != labels.end();
        switch (term.kind) {
            case Term::Kind::kIs:
                return has && found->second == term.value;
            case Term::Kind::kIsNot:
                return !has || found->second != term.value;
            case Term::Kind::kHas:
                return has;
            case Term::Kind::kHasNot:
                return !has;
        }
        return false;
    });
}

std::string LabelSelector::text() const {
    std::string text;
    for (const Term& term : terms_) {
        if (!text.empty()) text += ',';
        if (term.kind == Term::Kind::kHasNot) text += '!';
        text += term.key;
        if (term.kind == Term::Kind::kIs) text += "=" + value_text(term.value);
        if (term.kind == Term::Kind::kIsNot) text += "!=" + value_text(term.value);
    }
    return text;
}

}  // namespace asip::bus
