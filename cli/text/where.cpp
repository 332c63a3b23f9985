// SPDX-License-Identifier: Apache-2.0
#include "cli/text/where.hpp"

#include <algorithm>
#include <charconv>
#include <nlohmann/json.hpp>
#include <optional>

#include "asip/bus/pattern.hpp"
#include "asip/model/json.hpp"
#include "asip/text/duration.hpp"
#include "asip/text/nearest.hpp"
#include "cli/text/words.hpp"

namespace asip::cli {

struct Where::Node {
    enum class Kind { kAnd, kOr, kNot, kTest };
    Kind kind = Kind::kTest;
    std::vector<std::shared_ptr<const Node>> children{};
    std::string path{};
    std::string sign{};  ///< empty: is there
    std::string value{};
};

namespace {

using Json = nlohmann::json;
using NodePtr = std::shared_ptr<const Where::Node>;

constexpr std::size_t kMaxWhereBytes = 1000;
constexpr int kMaxWhereDepth = 30;
constexpr std::string_view kSignCharacters = "=!<>~";

struct Token {
    enum class Kind { kWord, kQuoted, kSign, kOpen, kClose, kEnd };
    Kind kind = Kind::kEnd;
    std::string text{};
};

Expected<std::vector<Token>> where_tokens(std::string_view text) {
    std::vector<Token> tokens;
    for (std::size_t i = 0; i < text.size();) {
        const char c = text[i];
        if (c == ' ' || c == '\t') {
            ++i;
        } else if (c == '(' || c == ')') {
            tokens.push_back({c == '(' ? Token::Kind::kOpen : Token::Kind::kClose, std::string(1, c)});
            ++i;
        } else if (c == '\'' || c == '"') {
            const auto end = text.find(c, i + 1);
            if (end == std::string_view::npos) return fail("where: a quote is never closed");
            tokens.push_back({Token::Kind::kQuoted, std::string(text.substr(i + 1, end - i - 1))});
            i = end + 1;
        } else {
            const bool sign = kSignCharacters.find(c) != std::string_view::npos;
            auto end = i;
            while (end < text.size() && (kSignCharacters.find(text[end]) != std::string_view::npos) == sign &&
                   std::string_view(" \t()'\"").find(text[end]) == std::string_view::npos)
                ++end;
            tokens.push_back(
                {sign ? Token::Kind::kSign : Token::Kind::kWord, std::string(text.substr(i, end - i))});
            i = end;
        }
    }
    tokens.push_back({});
    return tokens;
}

class WhereParser {
  public:
    WhereParser(std::vector<Token> tokens, const std::vector<std::string>& fields)
        : tokens_(std::move(tokens)), fields_(fields) {}

    Expected<NodePtr> parse() {
        auto root = either(0);
        if (root && at().kind != Token::Kind::kEnd)
            return fail("where: '" + at().text + "' is not expected here; join conditions with and, or");
        return root;
    }

  private:
    const Token& at() const { return tokens_[next_]; }
    bool word(std::string_view text) {
        if (at().kind != Token::Kind::kWord || at().text != text) return false;
        ++next_;
        return true;
    }

    Expected<NodePtr> joined(Where::Node::Kind kind, std::string_view word_between, int depth,
                             Expected<NodePtr> (WhereParser::*part)(int)) {
        auto first = (this->*part)(depth);
        if (!first) return first;
        auto node = std::make_shared<Where::Node>();
        node->kind = kind;
        node->children.push_back(*first);
        while (word(word_between)) {
            auto more = (this->*part)(depth);
            if (!more) return more;
            node->children.push_back(*more);
        }
        return node->children.size() == 1 ? node->children.front() : NodePtr(node);
    }

    Expected<NodePtr> either(int depth) {
        return joined(Where::Node::Kind::kOr, "or", depth, &WhereParser::all);
    }
    Expected<NodePtr> all(int depth) {
        return joined(Where::Node::Kind::kAnd, "and", depth, &WhereParser::one);
    }

    Expected<NodePtr> one(int depth) {
        if (depth > kMaxWhereDepth) return fail("where: too many parentheses");
        if (word("not")) {
            auto inner = one(depth + 1);
            if (!inner) return inner;
            auto node = std::make_shared<Where::Node>();
            node->kind = Where::Node::Kind::kNot;
            node->children.push_back(*inner);
            return NodePtr(node);
        }
        if (at().kind == Token::Kind::kOpen) {
            ++next_;
            auto inner = either(depth + 1);
            if (!inner) return inner;
            if (at().kind != Token::Kind::kClose) return fail("where: '(' is never closed");
            ++next_;
            return inner;
        }
        return test();
    }

    Expected<NodePtr> test() {
        if (at().kind != Token::Kind::kWord)
            return fail("where: a member is expected" +
                        (at().text.empty() ? std::string(" at the end") : " before '" + at().text + "'") +
                        ", as in chip=ATmega328P");
        auto node = std::make_shared<Where::Node>();
        node->path = tokens_[next_++].text;
        const auto first = node->path.substr(0, node->path.find('.'));
        if (std::find(fields_.begin(), fields_.end(), first) == fields_.end())
            return fail("where: there is no \"" + first + "\"" + text::did_you_mean(first, fields_) +
                        "; there are " + listed(fields_));
        if (at().kind != Token::Kind::kSign) return NodePtr(node);
        node->sign = tokens_[next_++].text;
        if (node->sign == "==") node->sign = "=";
        static const std::vector<std::string> kSigns{"=", "!=", "<", "<=", ">", ">=", "~", "!~"};
        if (std::find(kSigns.begin(), kSigns.end(), node->sign) == kSigns.end())
            return fail("where: '" + node->sign + "' is none of " + listed(kSigns));
        if (at().kind != Token::Kind::kWord && at().kind != Token::Kind::kQuoted)
            return fail("where: a value is expected behind " + node->path + node->sign);
        node->value = tokens_[next_++].text;
        return NodePtr(node);
    }

    std::vector<Token> tokens_;
    const std::vector<std::string>& fields_;
    std::size_t next_ = 0;
};

/// Every value that `path` leads to.
void collect_values(const Json& value, std::string_view path, std::vector<const Json*>& found) {
    if (path.empty()) {
        if (value.is_array()) {
            for (const auto& element : value)
                collect_values(element, path, found);
        } else {
            found.push_back(&value);
        }
        return;
    }
    const std::string key(path.substr(0, path.find('.')));
    const auto rest = path.substr(std::min(key.size() + 1, path.size()));
    if (value.is_object()) {
        if (const auto member = value.find(key); member != value.end()) collect_values(*member, rest, found);
    } else if (value.is_array()) {
        std::size_t index = 0;
        const auto* end = key.data() + key.size();
        if (std::from_chars(key.data(), end, index).ptr == end) {
            if (index < value.size()) collect_values(value[index], rest, found);
            return;
        }
        for (const auto& element : value)
            collect_values(element, path, found);
    }
}

std::optional<double> number_in(const std::string& text) {
    double number = 0;
    const auto* end = text.data() + text.size();
    if (const auto read = std::from_chars(text.data(), end, number);
        read.ec == std::errc() && read.ptr == end)
        return number;
    if (const auto duration = text::parse_duration(text))
        return std::chrono::duration<double>(*duration).count();
    return std::nullopt;
}

/// Below 0, 0 or above 0, as `value` is less than, equal to or more than `text`.
int compared(const Json& value, const std::string& text) {
    if (value.is_number()) {
        if (const auto number = number_in(text)) {
            const auto left = value.get<double>();
            return left < *number ? -1 : left > *number ? 1 : 0;
        }
    }
    const auto left = value.is_string() ? value.get<std::string>() : model::dump_json(value);
    return left.compare(text);
}

bool is_there(const Json& value) {
    if (value.is_boolean()) return value.get<bool>();
    if (value.is_number()) return value.get<double>() != 0;
    return value.is_string() ? !value.get_ref<const std::string&>().empty() : !value.empty();
}

bool passes(const Where::Node& node, const Json& value) {
    if (node.sign.empty()) return is_there(value);
    if (node.sign.back() == '~') {
        const auto text = value.is_string() ? value.get<std::string>() : model::dump_json(value);
        return bus::matches_pattern(node.value, text);
    }
    const int order = compared(value, node.value);
    if (node.sign == "<") return order < 0;
    if (node.sign == "<=") return order <= 0;
    if (node.sign == ">") return order > 0;
    if (node.sign == ">=") return order >= 0;
    return order == 0;  // also of `!=`, which negates it
}

bool node_holds(const Where::Node& node, const Json& record) {
    const auto below = [&record](const NodePtr& child) { return node_holds(*child, record); };
    switch (node.kind) {
        case Where::Node::Kind::kAnd:
            return std::all_of(node.children.begin(), node.children.end(), below);
        case Where::Node::Kind::kOr:
            return std::any_of(node.children.begin(), node.children.end(), below);
        case Where::Node::Kind::kNot:
            return !below(node.children.front());
        case Where::Node::Kind::kTest:
            break;
    }
    std::vector<const Json*> values;
    collect_values(record, node.path, values);
    const bool found = std::any_of(values.begin(), values.end(),
                                   [&node](const Json* value) { return passes(node, *value); });
    return node.sign.starts_with('!') ? !found : found;
}

}  // namespace

Expected<Where> Where::parse(std::string_view text, const std::vector<std::string>& fields) {
    if (text.size() > kMaxWhereBytes) return fail("where: longer than 1000 characters");
    auto tokens = where_tokens(text);
    if (!tokens) return fail(tokens.error());
    auto root = WhereParser(std::move(*tokens), fields).parse();
    if (!root) return fail(root.error());
    return Where(std::move(*root));
}

bool Where::holds(const nlohmann::json& record) const {
    return node_holds(*root_, record);
}

}  // namespace asip::cli
