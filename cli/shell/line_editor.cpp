// SPDX-License-Identifier: Apache-2.0
#include "cli/shell/line_editor.hpp"

#include <histedit.h>
#include <langinfo.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <clocale>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <cwchar>
#include <cwctype>
#include <new>

#include "asip/program/options.hpp"
#include "cli/complete.hpp"
#include "cli/shell/line_history.hpp"
#include "cli/shell/shell_words.hpp"
#include "cli/terminal.hpp"
#include "cli/text/width.hpp"

#if defined(__has_feature)
#if __has_feature(address_sanitizer)
#include <sanitizer/lsan_interface.h>
#define ASIP_LEAKS_ARE_KNOWN 1
#endif
#endif

namespace asip::cli {
namespace {

/// What is allocated while one lives is no leak that sanitizers report.
#ifdef ASIP_LEAKS_ARE_KNOWN
using KnownLeak = __lsan::ScopedDisabler;
#else
struct KnownLeak {
    KnownLeak() {}
    ~KnownLeak() {}
};
#endif

constexpr std::size_t kMaxListed = 100;
constexpr const char* kUp = "\033[%zuA";
constexpr const char* kDown = "\033[%zuB";

struct ScreenSize {
    std::size_t rows = 24;
    std::size_t columns = 80;
    friend bool operator==(const ScreenSize&, const ScreenSize&) = default;
};

ScreenSize screen_size() {
    winsize size{};
    if (ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) != 0 || size.ws_col == 0 || size.ws_row == 0) return {};
    return {size.ws_row, size.ws_col};
}

/// libedit reads and draws characters of the locale; names are UTF-8.
void use_utf8() {
    std::setlocale(LC_CTYPE, "");
    if (std::strcmp(nl_langinfo(CODESET), "UTF-8") != 0) std::setlocale(LC_CTYPE, "C.UTF-8");
}

/// As libedit shows it: `^A` for a control character.
std::size_t columns_of(const wchar_t* from, const wchar_t* to) {
    std::size_t columns = 0;
    for (; from < to; ++from) {
        const int width = wcwidth(*from);
        columns += width >= 0 ? static_cast<std::size_t>(width) : *from < 0x20 || *from == 0x7f ? 2 : 8;
    }
    return columns;
}

std::string common_start(const std::vector<std::string>& words) {
    std::string start = words.front();
    for (const auto& word : words) {
        const auto end = std::mismatch(start.begin(), start.end(), word.begin(), word.end()).first;
        start.erase(end, start.end());
    }
    return start;
}

std::string in_columns(const std::vector<std::string>& words, std::size_t columns) {
    std::size_t width = 0;
    for (const auto& word : words)
        width = std::max(width, display_width(word));
    const std::size_t in_row = std::max<std::size_t>(1, columns / (width + 2));
    std::string text;
    for (std::size_t i = 0; i < std::min(words.size(), kMaxListed); ++i) {
        text += words[i];
        const bool last = (i + 1) % in_row == 0;
        text += last ? "\n" : std::string(width + 2 - display_width(words[i]), ' ');
    }
    if (!text.ends_with("\n")) text += "\n";
    if (words.size() > kMaxListed) text += "... " + std::to_string(words.size() - kMaxListed) + " more\n";
    return text;
}

}  // namespace

struct LineEditor::State {
    explicit State(Hooks its_hooks) : hooks(std::move(its_hooks)) {
        use_utf8();
        edit = el_init("asipctl", stdin, stdout, stderr);
        past = history_init();
        if (edit == nullptr || past == nullptr) throw std::bad_alloc();
        HistEvent event{};
        history(past, &event, H_SETSIZE, static_cast<int>(LineHistory::kMaxLines));
        history(past, &event, H_SETUNIQUE, 1);
        el_set(edit, EL_CLIENTDATA, this);
        el_set(edit, EL_PROMPT, &State::prompt);
        el_set(edit, EL_EDITOR, "emacs");
        el_set(edit, EL_HIST, history, past);
        el_set(edit, EL_GETCFN, &State::next_key);
        // Ctrl-C and Ctrl-Z are keys of the line, signals to whatever runs.
        el_set(edit, EL_SETTY, "-d", "-isig", nullptr);
        bind_keys();
        el_source(edit, nullptr);
    }
    ~State() {
        el_end(edit);
        history_end(past);
    }
    State(const State&) = delete;
    State& operator=(const State&) = delete;

    void bind_keys() {
        const KnownLeak names_and_texts;  // libedit copies them and does not free them
        el_set(edit, EL_ADDFN, "asip-complete", "Complete a word", &State::complete_key);
        el_set(edit, EL_ADDFN, "asip-leave", "Leave the line", &State::leave_key);
        el_set(edit, EL_ADDFN, "asip-suspend", "Suspend", &State::suspend_key);
        el_set(edit, EL_ADDFN, "asip-clear", "Clear the screen", &State::clear_key);
        el_set(edit, EL_ADDFN, "asip-ignore", "Nothing", &State::ignore_key);
        using Binding = std::array<const char*, 2>;
        for (const auto& [key, function] : {Binding{"^I", "asip-complete"},
                                            {"^C", "asip-leave"},
                                            {"^Z", "asip-suspend"},
                                            {"^L", "asip-clear"},
                                            {"\\034", "asip-ignore"},
                                            {"^R", "em-inc-search-prev"},
                                            {"\\e[3~", "ed-delete-next-char"},
                                            {"\\e[H", "ed-move-to-beg"},
                                            {"\\e[F", "ed-move-to-end"},
                                            {"\\e[1~", "ed-move-to-beg"},
                                            {"\\e[4~", "ed-move-to-end"},
                                            {"\\e[1;5D", "ed-prev-word"},
                                            {"\\e[1;5C", "em-next-word"},
                                            {"^W", "ed-delete-prev-word"}})
            el_set(edit, EL_BIND, key, function, nullptr);
    }

    static State& of(EditLine* edit) {
        void* data = nullptr;
        el_get(edit, EL_CLIENTDATA, &data);
        return *static_cast<State*>(data);
    }

    static char* prompt(EditLine* edit) {
        auto& state = of(edit);
        state.prompt_text = state.hooks.prompt();
        return state.prompt_text.data();
    }

    /// The next character; waits for it by the owner's hook.
    static int next_key(EditLine* edit, wchar_t* key) {
        auto& state = of(edit);
        for (;;) {
            if (state.take_character(*key)) {
                if (state.line_is_full() && std::iswprint(static_cast<wint_t>(*key)) != 0) continue;
                return 1;
            }
            if (!state.hooks.wait([&state] { return state.key_waits(); })) return 0;
            if (!state.fill()) return 0;
        }
    }

    bool line_is_full() const {
        const auto* line = el_wline(edit);
        return static_cast<std::size_t>(line->lastchar - line->buffer) >= kMaxShellLine / 4;
    }

    bool key_waits() {
        follow_size();
        pollfd input{STDIN_FILENO, POLLIN, 0};
        return poll(&input, 1, 0) > 0;
    }

    bool fill() {
        std::array<char, 4096> buffer{};
        const auto got = ::read(STDIN_FILENO, buffer.data(), buffer.size());
        if (got < 0 && (errno == EINTR || errno == EAGAIN)) return true;
        if (got <= 0) return false;
        pending.append(buffer.data(), static_cast<std::size_t>(got));
        return true;
    }

    /// Bytes that are not UTF-8 are left out.
    bool take_character(wchar_t& key) {
        while (!pending.empty()) {
            std::mbstate_t fresh{};
            const auto bytes = std::mbrtowc(&key, pending.data(), pending.size(), &fresh);
            if (bytes == static_cast<std::size_t>(-2) && pending.size() < MB_CUR_MAX) return false;
            if (bytes <= pending.size()) {
                pending.erase(0, std::max<std::size_t>(bytes, 1));
                return true;
            }
            pending.erase(0, 1);
        }
        return false;
    }

    /// Rows below the first one of the prompt: of the cursor, and of the end of the line.
    struct Rows {
        std::size_t cursor = 0;
        std::size_t last = 0;
    };
    Rows rows() const {
        const auto* line = el_wline(edit);
        const auto before = display_width(prompt_text);
        const auto cursor = before + columns_of(line->buffer, line->cursor);
        return {cursor / size.columns,
                std::max(cursor, before + columns_of(line->buffer, line->lastchar)) / size.columns};
    }

    std::string status() const {
        return movable ? for_terminal(hooks.status(size.columns - 1)) : std::string();
    }

    /// Before a line is edited, and after something was printed below it.
    void print_status() {
        status_text = status();
        if (!status_text.empty()) std::fprintf(stdout, "%s\n", status_text.c_str());
    }

    void follow_size() {
        const auto now = screen_size();
        if (now == size) return;
        size = now;
        el_resize(edit);
        if (reading) repaint({});
    }

    /// From the status on: `text`, the status and the line anew.
    void repaint(const std::string& text) {
        const auto at = rows();
        const auto up = at.cursor + (status_text.empty() ? 0 : 1);
        if (!movable || at.last + 2 >= size.rows) {
            if (!text.empty()) std::fprintf(stdout, "\n%s\n", text.c_str());
        } else {
            if (up != 0) std::fprintf(stdout, kUp, up);
            std::fputs("\r\033[J", stdout);
            if (!text.empty()) std::fprintf(stdout, "%s\n", text.c_str());
            print_status();
        }
        el_set(edit, EL_REFRESH);
    }

    static unsigned char complete_key(EditLine* edit, int key) { return of(edit).complete(key); }
    unsigned char complete(int key) {
        const auto* line = el_line(edit);
        const std::string typed(line->buffer, line->cursor);
        const auto found = without_unshowable(hooks.complete(typed));
        if (found.empty()) return CC_REFRESH_BEEP;
        if (found.front() == kOfferFiles || found.front() == kOfferFolders) return _el_fn_complete(edit, key);
        const auto start = typed_line("x " + typed).start;
        auto more = common_start(found);
        more.erase(0, std::min(start.size(), more.size()));
        if (found.size() == 1 && !found.front().ends_with("/") && !found.front().ends_with("=")) more += ' ';
        if (!more.empty()) return el_insertstr(edit, more.c_str()) == 0 ? CC_REFRESH : CC_ERROR;
        list(found);
        return CC_NORM;
    }

    /// To the last row of the line.
    void go_below() {
        const auto at = rows();
        if (movable && at.last != at.cursor) std::fprintf(stdout, kDown, at.last - at.cursor);
    }

    void list(const std::vector<std::string>& words) {
        go_below();
        std::fprintf(stdout, "\n%s", in_columns(words, size.columns).c_str());
        print_status();
        el_set(edit, EL_REFRESH);
    }

    static unsigned char leave_key(EditLine* edit, int) {
        auto& state = of(edit);
        state.left = true;
        state.go_below();
        std::fputs("^C\n", stdout);
        return CC_NEWLINE;
    }
    static unsigned char suspend_key(EditLine* edit, int) {
        auto& state = of(edit);
        el_set(edit, EL_PREP_TERM, 0);
        std::fputs("\n", stdout);
        std::fflush(stdout);
        kill(0, SIGTSTP);
        el_set(edit, EL_PREP_TERM, 1);
        state.print_status();
        el_set(edit, EL_REFRESH);
        return CC_NORM;
    }
    static unsigned char clear_key(EditLine* edit, int) {
        auto& state = of(edit);
        if (state.movable) std::fputs("\033[H\033[2J", stdout);
        state.print_status();
        el_set(edit, EL_REFRESH);
        return CC_NORM;
    }
    static unsigned char ignore_key(EditLine*, int) { return CC_NORM; }

    std::optional<std::string> read() {
        size = screen_size();
        el_resize(edit);
        left = false;
        // libedit would show the prompt first, and a Ctrl-D that comes at once would be lost.
        el_set(edit, EL_PREP_TERM, 1);
        print_status();
        std::fflush(stdout);
        reading = true;
        int count = 0;
        const char* const text = el_gets(edit, &count);
        reading = false;
        std::fflush(stdout);
        // Of an empty line, too, which is no end of the input.
        if (left) return std::string();
        if (text == nullptr || count <= 0) {
            std::fputs("\n", stdout);
            std::fflush(stdout);
            return std::nullopt;
        }
        std::string line(text, static_cast<std::size_t>(count));
        while (!line.empty() && (line.back() == '\n' || line.back() == '\r'))
            line.pop_back();
        return line;
    }

    Hooks hooks;
    EditLine* edit = nullptr;
    History* past = nullptr;
    std::string prompt_text, status_text, pending;
    ScreenSize size = screen_size();
    bool movable = knows_escapes(program::environment_variable("TERM"));
    bool reading = false;
    bool left = false;
};

LineEditor::LineEditor(Hooks hooks) : state_(std::make_unique<State>(std::move(hooks))) {}
LineEditor::~LineEditor() = default;

std::optional<std::string> LineEditor::read() {
    return state_->read();
}

void LineEditor::remember(const std::string& line) {
    HistEvent event{};
    history(state_->past, &event, H_ENTER, line.c_str());
}

void LineEditor::show_above(const std::string& text) {
    const auto shown = for_terminal(text);
    if (state_->reading) return state_->repaint(shown);
    std::fprintf(stdout, "%s\n", shown.c_str());
    std::fflush(stdout);
}

void LineEditor::show_status() {
    if (state_->reading && state_->movable && state_->status() != state_->status_text) state_->repaint({});
}

}  // namespace asip::cli
