//! Both ways to the host: a serial port and a HID, each with the same messages and commands.

use firmware_proto::ENCODED_MAX;
use firmware_proto::command::Command;
use firmware_proto::frame::{Message, WireError};
use firmware_proto::hid::{self, REPORT_LEN};
use firmware_proto::link::{CommandReceiver, encode_message};
use pad::light::State;
use pad::outbox::Outbox;
use pad::rate::Rate;
use rp2040_hal::usb::UsbBus;
use usb_device::bus::UsbBusAllocator;
use usb_device::device::{StringDescriptors, UsbDevice, UsbDeviceBuilder, UsbDeviceState, UsbVidPid};
use usbd_hid::hid_class::HIDClass;
use usbd_serial::SerialPort;

use crate::restart::fail;

/// Full speed carries one report in a millisecond; at faster rates only the serial port has samples.
const REPORTS_MAX_HZ: u16 = 1_000;

/// Reports that may wait: two clocks of the same rate drift past one another.
const REPORTS: usize = 4;

/// The version of the firmware as the USB has it, two digits each.
const RELEASE: u16 = 0x0010;

/// A serial port of this speed that is closed means the bootloader, as with other boards that have no button for it.
const BOOTLOADER_BAUD: u32 = 1_200;

/// Milliamperes: chip, converters and nine bridges.
const POWER_MA: usize = 150;

/// Bytes that the serial port keeps, each way.
const STORE: usize = 2 * ENCODED_MAX;

type Serial<'a> = SerialPort<'a, UsbBus, [u8; STORE], [u8; STORE]>;

/// Where a command came from, and its answer goes.
#[derive(Clone, Copy)]
pub(crate) enum Port {
    Serial,
    Hid,
}

/// The ports.
pub(crate) struct Ports<'a> {
    device: UsbDevice<'a, UsbBus>,
    serial: Serial<'a>,
    hid: HIDClass<'a, UsbBus>,
    outbox: Outbox,
    receiver: CommandReceiver,
    reports: [[u8; REPORT_LEN]; REPORTS],
    waiting: usize,
    serial_open: bool,
    serial_begun: bool,
    hid_begun: bool,
}

impl<'a> Ports<'a> {
    pub(crate) fn new(bus: &'a UsbBusAllocator<UsbBus>, serial_number: &'a str, product: &'a str) -> Self {
        let serial = SerialPort::new_with_store(bus, [0; STORE], [0; STORE]);
        let hid = HIDClass::new(bus, hid::REPORT_DESCRIPTOR, 1);
        let strings = StringDescriptors::default()
            .manufacturer("tactpad")
            .product(product)
            .serial_number(serial_number);
        let built = UsbDeviceBuilder::new(bus, UsbVidPid(hid::VENDOR_ID, hid::PRODUCT_ID))
            .device_release(RELEASE)
            .composite_with_iads()
            .max_packet_size_0(64)
            .and_then(|it| it.max_power(POWER_MA))
            .and_then(|it| it.strings(&[strings]));
        let device = built.unwrap_or_else(|_| fail(line!())).build();
        Self {
            device,
            serial,
            hid,
            outbox: Outbox::default(),
            receiver: CommandReceiver::new(),
            reports: [[0; REPORT_LEN]; REPORTS],
            waiting: 0,
            serial_open: false,
            serial_begun: false,
            hid_begun: false,
        }
    }

    fn is_configured(&self) -> bool {
        self.device.state() == UsbDeviceState::Configured
    }

    /// Does what the host wants, and hands on what waits.
    pub(crate) fn poll(&mut self) {
        self.device.poll(&mut [&mut self.serial, &mut self.hid]);
        if !self.is_configured() {
            self.outbox.clear();
            self.waiting = 0;
            return;
        }
        // Nobody listens to a port that is not open, and what lies there would be old when somebody does.
        if !self.serial.dtr() {
            self.outbox.clear();
        }
        self.hand_on();
    }

    fn hand_on(&mut self) {
        if !self.outbox.waiting().is_empty() {
            let sent = self.serial.write(self.outbox.waiting()).unwrap_or(0);
            self.outbox.sent(sent);
        }
        let _ = self.serial.flush();
        while self.waiting > 0 && self.hid.push_raw_input(&self.reports[0]).is_ok() {
            self.reports.copy_within(1..self.waiting, 0);
            self.waiting -= 1;
        }
    }

    /// The next sample of each port is the first of its kind.
    pub(crate) fn begin_anew(&mut self) {
        (self.serial_begun, self.hid_begun) = (false, false);
    }

    /// Sends a sample both ways. The first that a port takes after a start says that the pad started, whenever the host came.
    pub(crate) fn send(&mut self, sample: &Message, rate: Rate) {
        let marked = marked(*sample);
        let first = |begun| if begun { *sample } else { marked };
        if self.is_configured() {
            self.serial_begun |= self.post(&first(self.serial_begun));
            if rate.hz() <= REPORTS_MAX_HZ {
                self.hid_begun |= self.report(&first(self.hid_begun));
            }
            self.hand_on();
        }
    }

    /// Answers where the command came from.
    pub(crate) fn answer(&mut self, port: Port, answer: &Message) {
        match port {
            Port::Serial => self.post(answer),
            Port::Hid => self.report(answer),
        };
        self.hand_on();
    }

    /// Says whether there was room.
    fn post(&mut self, message: &Message) -> bool {
        let mut frame = [0; ENCODED_MAX];
        let len = encode_message(message, &mut frame);
        self.serial.dtr() && self.outbox.post(&frame[..len])
    }

    /// Says whether there was room.
    fn report(&mut self, message: &Message) -> bool {
        let Some(slot) = self.reports.get_mut(self.waiting) else { return false };
        *slot = hid::encode_message(message);
        self.waiting += 1;
        true
    }

    /// The next command from either port.
    pub(crate) fn command(&mut self) -> Option<(Port, Result<Command, WireError>)> {
        let mut byte = [0];
        while self.serial.read(&mut byte).is_ok_and(|count| count == 1) {
            if let Some(command) = self.receiver.push(byte[0]) {
                return Some((Port::Serial, command));
            }
        }
        let mut report = [0; REPORT_LEN];
        // By the endpoint, or by the control pipe of hosts that write reports there.
        let came = self.hid.pull_raw_output(&mut report).is_ok_and(|len| len == REPORT_LEN)
            || self.hid.pull_raw_report(&mut report).is_ok_and(|info| info.len == REPORT_LEN);
        came.then(|| (Port::Hid, hid::decode_command(&report)))
    }

    /// Whether the host has just closed the serial port at the speed that means the bootloader.
    pub(crate) fn asks_for_bootloader(&mut self) -> bool {
        let is_open = self.serial.dtr();
        let was_open = core::mem::replace(&mut self.serial_open, is_open);
        was_open && !is_open && self.serial.line_coding().data_rate() == BOOTLOADER_BAUD
    }

    /// What the light says of the host.
    pub(crate) fn state(&self) -> State {
        match self.device.state() {
            UsbDeviceState::Configured => State::Sending,
            UsbDeviceState::Suspend => State::Asleep,
            _ => State::Alone,
        }
    }
}

/// The same as the first sample after a start.
fn marked(message: Message) -> Message {
    match message {
        Message::Sample(mut sample) => {
            sample.status = sample.status.with_restarted();
            Message::Sample(sample)
        }
        Message::Contact(mut contact) => {
            contact.status = contact.status.with_restarted();
            Message::Contact(contact)
        }
        other => other,
    }
}
