#include "Board.h"

#include "Line.h"

namespace asip {

Board board;

void Board::add(Service& service) {
    Service* last = &io_;
    while (last->next_ != nullptr)
        last = last->next_;
    last->next_ = &service;
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
    if (job_ == Job::kNone) {
        receive();
    } else {
        continueJob();
    }
    io_.pollInputs();
    const uint8_t now = hw::milliseconds();
    const uint8_t elapsed = static_cast<uint8_t>(now - lastMs_);
    lastMs_ = now;
    if (elapsed != 0) tick(elapsed);
    for (Service* service = &io_; service != nullptr; service = service->next_)
        service->poll();
}

void Board::tick(uint8_t elapsedMs) {
    for (Service* service = &io_; service != nullptr; service = service->next_) {
        if (!service->countDown(elapsedMs) || !out.hasRoom()) continue;
        service->reload();
        service->reportValues();
    }
    if (kExtensions) countRateTrial(elapsedMs);
}

// Reads until a request is complete: what follows it waits, in the line's own buffer, for the next pass.
void Board::receive() {
    int16_t byte;
    while ((byte = line::read()) >= 0) {
        if (collect(static_cast<char>(byte))) {
            execute();
            return;
        }
    }
}

// True at the end of a line. Past its end a line only counts as too long; the first characters stay, to say
// which request it was.
bool Board::collect(char c) {
    if (c == '\n') return true;
    if (length_ >= kMaxRequestLength) {
        spoiled_ = true;
    } else {
        if (c == '\0') spoiled_ = true;
        line_[length_++] = c;
    }
    return false;
}

static char printable(char c) {
    return c > ' ' && c < 127 ? c : '?';
}

void Board::execute() {
    uint8_t length = length_;
    bool spoiled = spoiled_;
    length_ = 0;
    spoiled_ = false;
    if (length > 0 && line_[length - 1] == '\r') --length;
    line_[length] = '\0';
    if (length == 0 || line_[0] == '!') return;
    if (kExtensions && out.usesChecksum() && !acceptChecksum(length))
        return out.error('#', 'C', Error::kBadChecksum);

    const char id = line_[0];
    const bool whole = length >= 3 && line_[1] == ',' && (line_[3] == '\0' || line_[3] == ',');
    const char tag = length >= 3 ? printable(line_[2]) : '?';
    Service* const service = id == '#' ? nullptr : find(id);
    if (service == nullptr && id != '#') return out.error('Q', '?', Error::kInvalidService);
    Error error = Error::kUnknownRequest;
    if (spoiled) {
        error = Error::kBadArgument;
    } else if (whole) {
        Request request(line_);
        error = service == nullptr ? processSystem(request) : dispatch(*service, request);
    }
    if (error != Error::kNone) out.error(id, tag, error);
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
    while (job_ == Job::kList)
        continueList();
    out.character('!');
    out.text(text);
    out.end();
}

void Board::continueJob() {
    if (job_ == Job::kList) {
        continueList();
    } else if (kExtensions) {
        continueExtension();
    }
}

void Board::sendList(Service& service, char tag, uint8_t count) {
    startList(&service, service.id(), tag, count);
}

void Board::startList(Service* service, char id, char tag, uint8_t count) {
    out.event(id, tag);
    out.character(',');
    out.number(count);
    out.character(',');
    out.character('{');
    out.setInList(true);
    listService_ = service;
    listTag_ = tag;
    listIndex_ = 0;
    listCount_ = count;
    job_ = Job::kList;
}

void Board::continueList() {
    while (out.hasRoomForElement()) {
        if (listIndex_ == listCount_) {
            out.character('}');
            out.end();
            out.setInList(false);
            job_ = Job::kNone;
            return;
        }
        if (listIndex_ != 0) out.character(',');
        if (listService_ != nullptr) {
            listService_->reportValue(listIndex_);
        } else {
            writeSystemElement(listIndex_);
        }
        ++listIndex_;
    }
}

}  // namespace asip
