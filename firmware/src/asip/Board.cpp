// SPDX-License-Identifier: Apache-2.0
#include "Board.h"

#include "Line.h"

namespace asip {

Board board;
void (*Board::readAhead_)() = nullptr;
char* Board::longLine_ = nullptr;
uint8_t Board::longLineSize_ = 0;
uint8_t Board::busy_ = 0;
bool Board::hasBusyServices_ = false;

void Board::add(Service& service) {
    Service* last = &io_;
    for (uint8_t number = 1; number <= kMaxServices; ++number) {
        if (last->next_ == nullptr) {
            last->next_ = &service;
            return;
        }
        last = last->next_;
        if (last == &service) return;
    }
}

void Board::begin(FlashText sketch) {
    sketch_ = sketch;
    lastMs_ = hw::milliseconds();
    line::begin();
    restart();
    if (!io_.isStrict()) io_.setPeriod(kAnalogPeriodMs);
    out.character('!');
    out.text(sketch);
    out.text(F(" running on "));
    out.text(hw::chipName());
    out.text(F(" with Services: "));
    for (Service* service = &io_; service != nullptr; service = service->next_) {
        out.character(service->id());
        out.character(' ');
    }
    out.end();
}

void Board::restart() {
    for (Service* service = &io_; service != nullptr; service = service->next_) {
        service->setPeriod(0);
        service->begin();
    }
}

void Board::run() {
    const bool received = nextRequest();
    const bool executed = received && !out.usesChecksum() && io_.executeWrite(line(), length_);
    io_.pollInputs();  // before the rest of the request's work: what a write changed is reported sooner
    if (received) {
        execute(executed);
        beginNext();
    }
    const uint8_t now = hw::milliseconds();
    const uint8_t elapsed = static_cast<uint8_t>(now - lastMs_);
    lastMs_ = now;
    if (elapsed != 0) tick(elapsed);
    for (Service* service = io_.next_; service != nullptr; service = service->next_)
        service->poll();
}

// True when a request is complete and its turn has come: none is executed before the line can take its
// answer, so a flood of requests holds up nothing else. Long ones are read meanwhile, since they do not fit
// the line's own buffer.
bool Board::nextRequest() {
    if (readAhead_ != nullptr) readAhead_();
    if (!out.hasRoomForPiece()) return false;
    if (out.isHeld() && job_ != kSwitchRate) {
        continueList();
    } else if ((readAhead_ != nullptr || hasBusyServices_) && job_ == kExecute) {
        if (hasBusyServices_ && isBusy()) return false;
        job_ = kNoJob;
        return true;
    } else if (kExtensions && job_ != kNoJob) {
        continueExtension();
    } else {
        const bool complete = receive();
        if (!hasBusyServices_) return complete;
        if (complete) job_ = kExecute;
    }
    return false;
}

// Whether the service that the complete request is for is busy.
bool Board::isBusy() {
    return busy_ & busyBit(line()[0]);
}

void Board::setBusy(const Service& service, bool busy) {
    const uint8_t bit = busyBit(service.id());
    hasBusyServices_ = true;
    busy_ = static_cast<uint8_t>(busy ? busy_ | bit : busy_ & ~bit);
}

void Board::readAhead() {
    if (board.job_ == kNoJob && board.receive()) board.job_ = kExecute;
}

void Board::tick(uint8_t elapsedMs) {
    for (Service* service = &io_; service != nullptr; service = service->next_)
        service->countDown(elapsedMs);
    reportWhatIsDue();
    countWait(elapsedMs);
}

void Board::countWait(uint8_t elapsedMs) {
    if (waitMs_ == 0) return;
    if (waitMs_ > elapsedMs) {
        waitMs_ = static_cast<uint16_t>(waitMs_ - elapsedMs);
        return;
    }
    waitMs_ = 0;
    if (isExtended()) giveUpRate();
}

// Begins behind the service that reported last: one with a short period must not silence the others.
void Board::reportWhatIsDue() {
    Service* const last = listService_ == nullptr ? &io_ : listService_;
    Service* service = last;
    do {
        service = service->next_ == nullptr ? &io_ : service->next_;
        if (!service->isDue() || !out.hasRoom()) continue;
        service->setDue(false);
        service->reportValues();
    } while (service != last);
}

// Reads until a request is complete, and is true then: what follows it waits, in the line's own buffer, for
// the next pass.
bool Board::receive() {
    int16_t byte = line::read();
    if (byte < 0) return isQuiet();
    do {
        if (collect(static_cast<char>(byte))) return true;
        byte = line::read();
    } while (byte >= 0);
    if (!isExtended()) waitMs_ = length_ == kSpoiled ? kSpoiledMs : kSilenceMs;
    return false;
}

// True when what was collected is complete because nothing more came. A name or a token is not: half of one
// looks whole.
bool Board::isQuiet() {
    if (length_ == 0 || waitMs_ != 0 || isExtended()) return false;
    if (line()[0] == '#' && length_ > 3) length_ = kSpoiled;
    return true;
}

// Where no extension is in use, published clients leave out line ends: a request also ends where the next one
// begins, with a letter and a comma, which nothing but text holds behind its tag. Whether what is before it
// is all of a request is seen by its execution.
bool Board::beginsAnother(char c) {
    const uint8_t length = length_;
    if (c != ',' || length < 4 || length == kSpoiled || next_ != 0) return false;
    const char* const line = this->line();
    const char letter = line[length - 1];
    if (letter != '#' && (letter < 'A' || letter > 'Z')) return false;
    if (line[0] == '#' || line[0] == '!') return false;
    const Service* const service = find(line[0]);
    if (service != nullptr && service->countAndDue_ & Service::kHoldsText) return false;
    length_ = static_cast<uint8_t>(length - 1);
    next_ = static_cast<uint8_t>(letter);
    return true;
}

void Board::beginNext() {
    if (next_ == 0 || isExtended()) return;
    line()[0] = static_cast<char>(next_);
    line()[1] = ',';
    length_ = 2;
    next_ = 0;
    waitMs_ = kSilenceMs;
}

// True at the end of a request. Of one that is spoiled the first characters stay, to say which it was. As on
// 0.4 boards, blanks and control characters before a request do not count, and so does not the second
// character of a line end; but a zero may stand for bytes that were lost, which a peer with extensions hears.
bool Board::collect(char c) {
    const uint8_t length = length_;
    if (length == 0 && static_cast<uint8_t>(c) <= ' ' && (c != '\0' || !isExtended())) return false;
    if (c == '\n' || c == '\r' || beginsAnother(c)) return true;
    if (length >= maxLength() || c == '\0') {
        if (length < 3) line()[length] = line()[2] = '\0';
        length_ = kSpoiled;
    } else {
        line()[length] = c;
        length_ = static_cast<uint8_t>(length + 1);
    }
    return false;
}

// A buffer of the same size: the same service after a restart.
void Board::useLongLines(char* buffer, uint8_t size) {
    if (size < longLineSize_) return;
    readAhead_ = readAhead;
    longLine_ = buffer;
    longLineSize_ = size;
}

static char printable(char c) {
    return c > ' ' && c < 127 ? c : '?';
}

void Board::execute(bool executed) {
    uint8_t length = length_;
    length_ = 0;
    char* const line = this->line();
    const bool spoiled = length == kSpoiled;
    if (spoiled) length = 3;
    while (line[length - 1] == ' ')  // the first is none
        --length;
    line[length] = '\0';
    if (line[0] == '!') return;
    if (kExtensions && out.usesChecksum() && !acceptChecksum(length)) {
        return out.error('#', 'C', Error::kBadChecksum);
    }
    if (kExtensions) digestLine();
    if (executed) return;
    const Error error = spoiled ? Error::kBadArgument : process(length);
    if (error == Error::kNone) return;
    if (kExtensions) digest_ ^= static_cast<uint8_t>(error);
    const bool hasTag = length >= 3 && error != Error::kInvalidService;
    out.error(printable(line[0]), hasTag ? printable(line[2]) : '?', error);
}

Error Board::process(uint8_t length) {
    const char* const line = this->line();
    Service* service = nullptr;
    if (line[0] != '#') {
        service = find(line[0]);
        if (service == nullptr) return Error::kInvalidService;
    }
    if (length < 3 || line[1] != ',' || (line[3] != ',' && length > 3)) return Error::kUnknownRequest;
    Request request(line);
    return service == nullptr ? processSystem(request) : dispatch(*service, request);
}

Error Board::dispatch(Service& service, Request& request) {
    if (request.tag() != 'A' || service.count() == 0) return service.processRequest(request);
    const uint16_t period = request.number();
    if (!request.complete()) return Error::kBadArgument;
    service.setPeriod(period);
    return Error::kNone;
}

Service* Board::find(char id) {
    Service* service = &io_;
    while (service != nullptr && service->id() != id)
        service = service->next_;
    return service;
}

uint8_t Board::numberOf(const Service& wanted) const {
    uint8_t number = 0;
    for (const Service* service = &io_; service != &wanted; service = service->next_)
        ++number;
    return number;
}

Service* Board::serviceAt(uint8_t number) {
    Service* service = &io_;
    while (number-- > 0)
        service = service->next_;
    return service;
}

Error Board::claimPin(uint8_t pin, const Service& service) {
    return io_.claim(pin, numberOf(service));
}

bool Board::ownsPin(uint8_t pin, const Service& service) const {
    return pin < hw::kPins && io_.owner(pin) == numberOf(service);
}

bool Board::canClaim(uint8_t pin, const Service& service) const {
    return ownsPin(pin, service) || io_.isFree(pin);
}

void Board::releasePins(const Service& service) {
    io_.release(numberOf(service));
}

void Board::info(FlashText text) {
    while (out.isHeld())
        nextRequest();  // sends what is held: none is complete meanwhile
    out.character('!');
    out.text(text);
    out.end();
}

void Board::sendList(Service& service, char tag, uint8_t count) {
    startList(&service, service.id(), tag, count);
}

void Board::startList(Service* service, char id, char tag, uint8_t count) {
    out.answer(id, tag);
    out.number(count);
    out.character(',');
    out.character('{');
    out.hold(true);
    listService_ = service;
    listTag_ = tag;
    listIndex_ = 0;
    listCount_ = count;
}

// One element a pass: those of an analog event take a conversion each, 110 microseconds.
void Board::continueList() {
    if (listIndex_ == listCount_) {
        out.character('}');
        out.end();
        return out.hold(false);
    }
    if (listIndex_ != 0) out.character(',');
    if (listService_ != nullptr) {
        listService_->reportValue(listIndex_);
    } else {
        writeSystemElement(listIndex_);
    }
    ++listIndex_;
}

}  // namespace asip
