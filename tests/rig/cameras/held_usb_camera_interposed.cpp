// The USB of this test program: one bus with one ILCE-7M2 on it, which another program holds. libgphoto2's own USB
// driver asks libusb, and these functions answer in its place. What the driver asks only after it has the camera is not
// here.
#include <libusb-1.0/libusb.h>

#include <cstdint>

struct libusb_context {};
struct libusb_device {};
struct libusb_device_handle {};

namespace {

libusb_context context_here;
libusb_device camera;
libusb_device_handle opened;
libusb_device* bus[] = {&camera, nullptr};

constexpr libusb_endpoint_descriptor endpoint(std::uint8_t address, std::uint8_t kind) {
  return {.bLength = LIBUSB_DT_ENDPOINT_SIZE,
          .bDescriptorType = LIBUSB_DT_ENDPOINT,
          .bEndpointAddress = address,
          .bmAttributes = kind,
          .wMaxPacketSize = 512,
          .bInterval = 0,
          .bRefresh = 0,
          .bSynchAddress = 0,
          .extra = nullptr,
          .extra_length = 0};
}
const libusb_endpoint_descriptor endpoints[] = {endpoint(0x81, LIBUSB_TRANSFER_TYPE_BULK),
                                                endpoint(0x02, LIBUSB_TRANSFER_TYPE_BULK),
                                                endpoint(0x83, LIBUSB_TRANSFER_TYPE_INTERRUPT)};
const libusb_interface_descriptor still_image{.bLength = LIBUSB_DT_INTERFACE_SIZE,
                                              .bDescriptorType = LIBUSB_DT_INTERFACE,
                                              .bInterfaceNumber = 0,
                                              .bAlternateSetting = 0,
                                              .bNumEndpoints = 3,
                                              .bInterfaceClass = LIBUSB_CLASS_IMAGE,
                                              .bInterfaceSubClass = 1,
                                              .bInterfaceProtocol = 1,
                                              .iInterface = 0,
                                              .endpoint = endpoints,
                                              .extra = nullptr,
                                              .extra_length = 0};
const libusb_interface only_interface{.altsetting = &still_image, .num_altsetting = 1};
libusb_config_descriptor only_configuration{.bLength = LIBUSB_DT_CONFIG_SIZE,
                                            .bDescriptorType = LIBUSB_DT_CONFIG,
                                            .wTotalLength = LIBUSB_DT_CONFIG_SIZE + LIBUSB_DT_INTERFACE_SIZE,
                                            .bNumInterfaces = 1,
                                            .bConfigurationValue = 1,
                                            .iConfiguration = 0,
                                            .bmAttributes = 0xc0,
                                            .MaxPower = 0,
                                            .interface = &only_interface,
                                            .extra = nullptr,
                                            .extra_length = 0};

}  // namespace

extern "C" {

int libusb_init(libusb_context** context) {
  *context = &context_here;
  return 0;
}
void libusb_exit(libusb_context*) {}

ssize_t libusb_get_device_list(libusb_context*, libusb_device*** list) {
  *list = bus;
  return 1;
}
void libusb_free_device_list(libusb_device**, int) {}

uint8_t libusb_get_bus_number(libusb_device*) {
  return 1;
}
uint8_t libusb_get_device_address(libusb_device*) {
  return 4;
}

int libusb_get_device_descriptor(libusb_device*, libusb_device_descriptor* found) {
  *found = {.bLength = LIBUSB_DT_DEVICE_SIZE,
            .bDescriptorType = LIBUSB_DT_DEVICE,
            .bcdUSB = 0x0200,
            .bDeviceClass = 0,
            .bDeviceSubClass = 0,
            .bDeviceProtocol = 0,
            .bMaxPacketSize0 = 64,
            .idVendor = 0x054c,
            .idProduct = 0x0a6a,
            .bcdDevice = 0x0330,
            .iManufacturer = 0,
            .iProduct = 0,
            .iSerialNumber = 0,
            .bNumConfigurations = 1};
  return 0;
}
int libusb_get_config_descriptor(libusb_device*, uint8_t, libusb_config_descriptor** found) {
  *found = &only_configuration;
  return 0;
}
void libusb_free_config_descriptor(libusb_config_descriptor*) {}

int libusb_get_max_packet_size(libusb_device*, unsigned char) {
  return 512;
}

int libusb_open(libusb_device*, libusb_device_handle** handle) {
  *handle = &opened;
  return 0;
}
void libusb_close(libusb_device_handle*) {}
int libusb_kernel_driver_active(libusb_device_handle*, int) {
  return 0;
}
int libusb_claim_interface(libusb_device_handle*, int) {
  return LIBUSB_ERROR_BUSY;  // the kernel's answer while another process has the interface
}
int libusb_release_interface(libusb_device_handle*, int) {
  return LIBUSB_ERROR_NOT_FOUND;
}
int libusb_handle_events(libusb_context*) {
  return 0;
}
int libusb_handle_events_timeout(libusb_context*, timeval*) {
  return 0;
}

}  // extern "C"
