//! The board's image lies where the microcontroller has memory, and starts where it looks.

use std::fs;
use std::ops::Range;
use std::path::Path;

use anyhow::{Context, Result, ensure};
use object::read::elf::{ElfFile32, ProgramHeader};
use object::{Object, ObjectSection, elf};

/// Memory of the STM32F411RE (its data sheet, DS10314, section 5).
const FLASH: Range<u64> = 0x0800_0000..0x0808_0000;
const RAM: Range<u64> = 0x2000_0000..0x2002_0000;
/// What a Cortex-M reads first, at the start of its flash: stack pointer and reset handler.
const VECTORS: &str = ".vector_table";
/// What is written while it runs.
const WRITTEN: &[&str] = &[".data", ".bss", ".uninit"];

/// What an image says of where it goes.
#[derive(Clone)]
struct Image {
    vectors: u64,
    stack: u64,
    reset: u64,
    entry: u64,
    /// What a programmer writes to the board: addresses.
    loaded: Vec<Range<u64>>,
    /// Name and addresses of the sections in [`WRITTEN`].
    written: Vec<(String, Range<u64>)>,
}

/// Reads the image in a file and checks it.
pub fn check(file: &Path) -> Result<()> {
    let image = Image::read(&fs::read(file).with_context(|| file.display().to_string())?)?;
    image.check()?;
    println!(
        "the board's image: vectors at {:#010x}, stack from {:#010x}, entry {:#010x}",
        image.vectors, image.stack, image.entry
    );
    Ok(())
}

impl Image {
    fn read(bytes: &[u8]) -> Result<Self> {
        let file = ElfFile32::<object::Endianness>::parse(bytes)?;
        let vectors = file.section_by_name(VECTORS).with_context(|| format!("no {VECTORS}"))?;
        let [stack, reset] = match vectors.data()? {
            [a, b, c, d, e, f, g, h, ..] => [[*a, *b, *c, *d], [*e, *f, *g, *h]],
            _ => anyhow::bail!("{VECTORS} is cut short"),
        };
        let endian = file.endian();
        let loaded = file
            .elf_program_headers()
            .iter()
            .filter(|header| header.p_type(endian) == elf::PT_LOAD && header.p_filesz(endian) > 0)
            .map(|header| addresses(header.p_paddr(endian), u64::from(header.p_filesz(endian))))
            .collect();
        let mut written = Vec::new();
        for name in WRITTEN {
            let section = file.section_by_name(name).with_context(|| format!("no {name}"))?;
            written.push((String::from(*name), addresses(section.address(), section.size())));
        }
        Ok(Self {
            vectors: vectors.address(),
            stack: u64::from(u32::from_le_bytes(stack)),
            reset: u64::from(u32::from_le_bytes(reset)),
            entry: file.entry(),
            loaded,
            written,
        })
    }

    fn check(&self) -> Result<()> {
        let Self { vectors, stack, reset, entry, .. } = self;
        ensure!(
            *vectors == FLASH.start,
            "the vectors lie at {vectors:#010x}, not {:#010x}",
            FLASH.start
        );
        ensure!(*stack == RAM.end, "the stack starts at {stack:#010x}, not {:#010x}", RAM.end);
        ensure!(reset == entry, "reset goes to {reset:#010x}, the entry is {entry:#010x}");
        // The lowest bit says that the code is Thumb.
        ensure!(
            entry % 2 == 1 && FLASH.contains(entry),
            "the entry is {entry:#010x}, no Thumb code in flash"
        );
        ensure!(!self.loaded.is_empty(), "nothing is loaded");
        for part in &self.loaded {
            ensure!(within(part, &FLASH), "{part:#010x?} is to be loaded outside the flash");
        }
        for (name, part) in &self.written {
            ensure!(within(part, &RAM), "{name} lies at {part:#010x?}, outside the RAM");
        }
        Ok(())
    }
}

fn addresses(start: impl Into<u64>, size: u64) -> Range<u64> {
    let start = start.into();
    start..start + size
}

fn within(part: &Range<u64>, memory: &Range<u64>) -> bool {
    memory.start <= part.start && part.end <= memory.end
}

#[cfg(test)]
mod tests {
    use super::*;

    fn good() -> Image {
        Image {
            vectors: 0x0800_0000,
            stack: 0x2002_0000,
            reset: 0x0800_0199,
            entry: 0x0800_0199,
            loaded: vec![0x0800_0000..0x0800_4000, 0x0800_4000..0x0800_4518],
            written: vec![(String::from(".bss"), 0x2000_0038..0x2000_0044)],
        }
    }

    /// What the check says of an image.
    fn complaint(change: impl FnOnce(&mut Image)) -> String {
        let mut image = good();
        change(&mut image);
        image.check().unwrap_err().to_string()
    }

    #[test]
    fn an_image_in_its_place_passes() {
        assert!(good().check().is_ok());
    }

    #[test]
    fn each_thing_out_of_place_is_named() {
        assert!(complaint(|image| image.vectors = 0).contains("vectors lie at 0x00000000"));
        assert!(
            complaint(|image| image.stack = 0x2040_0000).contains("stack starts at 0x20400000")
        );
        assert!(complaint(|image| image.reset = 0x0800_0201).contains("reset goes to"));
        let elsewhere =
            |entry| move |image: &mut Image| (image.reset, image.entry) = (entry, entry);
        assert!(complaint(elsewhere(0x199)).contains("no Thumb code in flash"));
        assert!(complaint(elsewhere(0x0800_0198)).contains("no Thumb code in flash"));
        assert!(complaint(|image| image.loaded.clear()).contains("nothing is loaded"));
        let too_long = 0x0800_0000..0x0808_0001;
        assert!(complaint(|image| image.loaded.push(too_long)).contains("outside the flash"));
        let too_far = (String::from(".data"), 0x2001_fff0..0x2002_0004);
        assert!(complaint(|image| image.written.push(too_far)).contains(".data lies at"));
    }

    #[test]
    fn what_is_no_image_is_refused() {
        assert!(Image::read(b"").is_err());
        assert!(Image::read(b"\x7fELF").is_err());
    }
}
