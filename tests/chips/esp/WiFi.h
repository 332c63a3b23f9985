// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Client.h>

typedef enum { WL_IDLE_STATUS = 0, WL_CONNECTED = 3, WL_DISCONNECTED = 6 } wl_status_t;
typedef enum { WIFI_OFF = 0, WIFI_STA = 1, WIFI_AP = 2 } WiFiMode_t;
#define WIFI_STA WIFI_STA

class WiFiClient : public Client {
  public:
    WiFiClient();
    WiFiClient(const WiFiClient& other);
    WiFiClient& operator=(const WiFiClient& other);
    ~WiFiClient() override;
    int connect(IPAddress ip, uint16_t port) override;
    int connect(const char* host, uint16_t port) override;
    size_t write(uint8_t byte) override;
    size_t write(const uint8_t* bytes, size_t size) override;
    int available() override;
    int read() override;
    int read(uint8_t* bytes, size_t size) override;
    int peek() override;
    ASIP_STOPPED stop() override;
    uint8_t connected() override;
    operator bool() override;

  private:
    void* context_;
};

class WiFiServer {
  public:
    WiFiServer(uint16_t port);
    WiFiClient available();
    void begin();

  private:
    uint16_t port_;
};

class WiFiClass {
  public:
    bool mode(WiFiMode_t mode);
    wl_status_t begin(const char* network, const char* password = nullptr);
    wl_status_t status();
};
extern WiFiClass WiFi;
