//! Images of other programs are read, our own come back, and no file makes the reader fail in any other way than by a
//! message: independent encoders, files by hand, cut and damaged ones.

mod common;

use common::random::Random;
use std::fs;
use std::io::Cursor;
use std::path::{Path, PathBuf};
use tempfile::TempDir;
use wavetrace::error::Error;
use wavetrace::output::{self, Format, Image, ImageFile, Layers, Metadata, Tone};

struct Folder(TempDir);

impl Folder {
    fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }
    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }
    /// What a file of these bytes holds; the name tells nothing.
    fn read(&self, bytes: &[u8]) -> Result<ImageFile, Error> {
        let path = self.path("a file");
        fs::write(&path, bytes).unwrap();
        output::read(&path)
    }
    fn pixels(&self, bytes: &[u8]) -> Vec<[f32; 3]> {
        self.read(bytes).unwrap().image.pixels
    }
    /// The message about a file that cannot be read.
    fn fails(&self, bytes: &[u8], part: &str) {
        let error = self.read(bytes).expect_err(part);
        let text = error.to_string();
        assert!(matches!(error, Error::Decode { .. }), "{text}");
        assert!(
            text.contains(part) && text.contains("a file: found ") && text.contains(", expected "),
            "{part}: {text}"
        );
    }
}

/// IEC 61966-2-1 backwards.
fn linear(encoded: f64) -> f32 {
    (if encoded <= 0.04045 { encoded / 12.92 } else { ((encoded + 0.055) / 1.055).powf(2.4) }) as f32
}

fn noise(width: u32, height: u32) -> Image {
    let mut random = Random(u64::from(width * height));
    let pixels = (0..width * height).map(|_| [random.unit(), 3.0 * random.unit(), random.within(-0.1, 0.1)]);
    Image { width, height, pixels: pixels.collect() }
}

fn metadata(partial: bool) -> Metadata {
    let entries = [("scene", "scènes/box.json"), ("seed", "7"), ("spp", "16")];
    Metadata { entries: entries.map(|(key, value)| (key.to_owned(), value.to_owned())).to_vec(), partial }
}

fn bits(pixels: &[[f32; 3]]) -> Vec<u32> {
    pixels.as_flattened().iter().map(|c| c.to_bits()).collect()
}

#[test]
fn our_own_images_come_back() {
    let folder = Folder::new();
    let image = noise(37, 23);
    for (ending, format) in [("png", Format::Png), ("ppm", Format::Ppm), ("exr", Format::Exr), ("hdr", Format::Hdr)] {
        for partial in [false, true] {
            let path = folder.path("a").with_extension(ending);
            output::write(&path, &image, &metadata(partial), &Tone::default()).unwrap();
            let mut found = output::read(&path).unwrap();
            assert_eq!((found.format, found.image.width, found.image.height), (format, 37, 23));
            assert_eq!((found.variance, found.remarks), (None, Vec::new()));
            found.metadata.entries.sort();
            assert_eq!(found.metadata, metadata(partial), "{ending}");
            assert_eq!(found.metadata.get("spp"), Some("16"));
            match format {
                Format::Exr => assert_eq!(bits(&found.image.pixels), bits(&image.pixels)),
                // What was read is written as the same bytes.
                _ => {
                    let again = folder.path("again").with_extension(ending);
                    output::write(&again, &found.image, &metadata(partial), &Tone::default()).unwrap();
                    assert_eq!(fs::read(again).unwrap(), fs::read(path).unwrap(), "{ending}");
                }
            }
        }
    }
}

#[test]
fn variances_come_back_from_exr_alone() {
    let folder = Folder::new();
    let (image, mut variance) = (noise(19, 40), noise(40, 19).pixels);
    variance[5] = [f32::INFINITY, 0.0, f32::MIN_POSITIVE];
    let layers = Layers { image: &image, variance: Some(&variance) };
    for ending in ["png", "ppm", "exr", "hdr"] {
        let path = folder.path("a").with_extension(ending);
        output::write(&path, layers, &metadata(false), &Tone::default()).unwrap();
        let found = output::read(&path).unwrap();
        assert_eq!(found.variance.as_deref().map(bits), (ending == "exr").then(|| bits(&variance)));
        if ending == "exr" {
            assert_eq!(bits(&found.image.pixels), bits(&image.pixels));
        }
    }
    // Other programs see the colours where they always are.
    let file = exr::prelude::read_first_rgba_layer_from_file(
        folder.path("a.exr"),
        |size, _| vec![[0_f32; 3]; size.area()],
        |pixels, at, (r, g, b, _): (f32, f32, f32, f32)| pixels[at.y() * 19 + at.x()] = [r, g, b],
    );
    assert_eq!(bits(&file.unwrap().layer_data.channel_data.pixels), bits(&image.pixels));
    let uneven = Layers { image: &image, variance: Some(&variance[1..]) };
    let error = output::write(&folder.path("b.exr"), uneven, &metadata(false), &Tone::default()).unwrap_err();
    assert!(error.to_string().contains("found 759 variances, expected one for each of 760 pixels"), "{error}");
    assert!(!folder.path("b.exr").exists());
}

/// A PNG by the crate's own encoder: chunks are written before the pixels.
fn png(
    size: [u32; 2],
    color: png::ColorType,
    depth: png::BitDepth,
    data: &[u8],
    setup: impl Fn(&mut png::Encoder<'_, &mut Vec<u8>>),
) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, size[0], size[1]);
    encoder.set_color(color);
    encoder.set_depth(depth);
    setup(&mut encoder);
    encoder.write_header().unwrap().write_image_data(data).unwrap();
    bytes
}

#[test]
fn images_of_one_colour_are_read_up_to_a_size() {
    use png::{BitDepth, ColorType};
    let folder = Folder::new();
    let grey =
        |height: u32| png([4096, height], ColorType::Grayscale, BitDepth::One, &vec![0; 512 * height as usize], |_| {});
    assert_eq!(folder.pixels(&grey(2048)).len(), 1 << 23);
    folder.fails(&grey(2049), "found an image of 4096x2049 pixels in ");
    // What has more bytes may have more pixels.
    let mut long = grey(2049);
    long.resize((1 << 20) + 4096 / 8, 0);
    assert_eq!(folder.read(&long).unwrap().image.height, 2049);
    let head = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 2049 +X 4096\n";
    let row = [9, 9, 9, 128, 1, 1, 1, 255, 1, 1, 1, 15];
    folder.fails(&[&head[..], &row.repeat(2049)].concat(), "found an image of 4096x2049 pixels in ");
}

#[test]
fn png_of_every_kind() {
    use png::{BitDepth, ColorType};
    let folder = Folder::new();
    let code = |code: u32, top: u32| linear(f64::from(code) / f64::from(top));
    // Grey of 1 to 16 bits: in each the last code is white.
    for (depth, packed, codes, top) in [
        (BitDepth::One, &[0b1010_0000_u8][..], [1, 0, 1, 0], 1),
        (BitDepth::Two, &[0b0001_1011], [0, 1, 2, 3], 3),
        (BitDepth::Four, &[0x0f, 0x3a], [0, 15, 3, 10], 15),
        (BitDepth::Eight, &[0, 255, 99, 1], [0, 255, 99, 1], 255),
        (BitDepth::Sixteen, &[0, 0, 255, 255, 1, 2, 128, 0], [0, 65535, 258, 32768], 65535),
    ] {
        let expected = codes.map(|c| [code(c, top); 3]);
        assert_eq!(folder.pixels(&png([4, 1], ColorType::Grayscale, depth, packed, |_| {})), expected, "{depth:?}");
    }
    let rgb = [code(10, 255), code(20, 255), code(255, 255)];
    assert_eq!(folder.pixels(&png([1, 1], ColorType::Rgb, BitDepth::Eight, &[10, 20, 255], |_| {})), [rgb]);
    // Alpha is left out, whatever it is.
    for alpha in [0, 7, 255] {
        let bytes = png([1, 1], ColorType::Rgba, BitDepth::Eight, &[10, 20, 255, alpha], |_| {});
        assert_eq!(folder.pixels(&bytes), [rgb]);
        let bytes = png([1, 1], ColorType::GrayscaleAlpha, BitDepth::Eight, &[20, alpha], |_| {});
        assert_eq!(folder.pixels(&bytes), [[rgb[1]; 3]]);
    }
    let deep = png([1, 1], ColorType::Rgba, BitDepth::Sixteen, &[1, 2, 3, 4, 5, 6, 0, 0], |_| {});
    assert_eq!(folder.pixels(&deep), [[code(258, 65535), code(772, 65535), code(1286, 65535)]]);
    let palette = png([3, 1], ColorType::Indexed, BitDepth::Two, &[0b0001_0000], |encoder| {
        encoder.set_palette(vec![10, 20, 255, 0, 0, 0]);
        encoder.set_trns(vec![3, 0]);
    });
    assert_eq!(folder.pixels(&palette), [rgb, [0.0; 3], rgb]);
}

#[test]
fn png_says_how_it_is_encoded() {
    use png::{BitDepth, ColorType, ScaledFloat};
    let folder = Folder::new();
    let grey = |setup: &dyn Fn(&mut png::Encoder<'_, &mut Vec<u8>>)| {
        folder.read(&png([2, 1], ColorType::Grayscale, BitDepth::Eight, &[51, 255], setup)).unwrap()
    };
    let first = |file: &ImageFile| file.image.pixels[0][0];
    let near = |found: f32, expected: f64| assert!((f64::from(found) - expected).abs() < 1e-6, "{found} {expected}");
    let srgb = f64::from(linear(0.2));
    near(first(&grey(&|_| {})), srgb);
    // 1/2.2 is what sRGB files say; 1 is linear; others are powers.
    for (gamma, expected) in [(0.45455, srgb), (1.0, 0.2), (0.5, 0.04)] {
        near(first(&grey(&|encoder| encoder.set_source_gamma(ScaledFloat::new(gamma)))), expected);
    }
    near(
        first(&grey(&|encoder| {
            encoder.set_source_gamma(ScaledFloat::new(1.0));
            encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
        })),
        srgb,
    );
    // cICP goes before all; its chunk stands behind IHDR, which is 33 bytes from the start.
    let cicp = |transfer: u8, primaries: u8| {
        let mut bytes = png([2, 1], ColorType::Grayscale, BitDepth::Eight, &[51, 255], |_| {});
        bytes.splice(33..33, chunk(b"cICP", &[primaries, transfer, 0, 1]));
        folder.read(&bytes)
    };
    near(first(&cicp(8, 1).unwrap()), 0.2);
    near(first(&cicp(13, 1).unwrap()), srgb);
    assert_eq!(cicp(13, 9).unwrap().remarks, ["its primaries are taken as Rec. 709"]);
    assert!(
        cicp(16, 9).unwrap_err().to_string().contains("found transfer function 16 (cICP), expected 13 (sRGB) or 8")
    );
    let profile = [b"name\0\0".to_vec(), deflated(b"a profile")].concat();
    let mut bytes = png([2, 1], ColorType::Grayscale, BitDepth::Eight, &[51, 255], |_| {});
    bytes.splice(33..33, chunk(b"iCCP", &profile));
    let found = folder.read(&bytes).unwrap();
    near(first(&found), srgb);
    assert_eq!(found.remarks, ["its colour profile is not heeded, it is taken as sRGB"]);
}

/// zlib without compression.
fn deflated(data: &[u8]) -> Vec<u8> {
    let length = data.len() as u16;
    let (mut a, mut b) = (1_u32, 0_u32);
    for &byte in data {
        a = (a + u32::from(byte)) % 65521;
        b = (b + a) % 65521;
    }
    let mut out = vec![0x78, 0x01, 0x01];
    out.extend(length.to_le_bytes());
    out.extend((!length).to_le_bytes());
    out.extend(data);
    out.extend((b << 16 | a).to_be_bytes());
    out
}

/// A PNG chunk with its length and checksum.
fn chunk(kind: &[u8; 4], data: &[u8]) -> Vec<u8> {
    let body = [&kind[..], data].concat();
    let mut crc = u32::MAX;
    for &byte in &body {
        crc ^= u32::from(byte);
        for _ in 0..8 {
            crc = if crc & 1 == 1 { crc >> 1 ^ 0xedb8_8320 } else { crc >> 1 };
        }
    }
    [&(data.len() as u32).to_be_bytes()[..], &body, &(!crc).to_be_bytes()].concat()
}

#[test]
fn ppm_of_every_kind() {
    use image::codecs::pnm::{PnmEncoder, PnmSubtype, SampleEncoding};
    let folder = Folder::new();
    let codes: Vec<u8> = (0..4 * 3 * 3).map(|i| (i * 7 % 256) as u8).collect();
    let expected: Vec<f32> = codes.iter().map(|&c| linear(f64::from(c) / 255.0)).collect();
    for encoding in [SampleEncoding::Ascii, SampleEncoding::Binary] {
        let mut bytes = Vec::new();
        let encoder = PnmEncoder::new(&mut bytes).with_subtype(PnmSubtype::Pixmap(encoding));
        image::ImageEncoder::write_image(encoder, &codes, 4, 3, image::ExtendedColorType::Rgb8).unwrap();
        assert_eq!(folder.pixels(&bytes).as_flattened(), expected, "{encoding:?}");
    }
    let at = |code: u32, top: u32| linear(f64::from(code) / f64::from(top));
    // Comments anywhere in the header, any white space, another largest value, 16 bits, another image behind.
    let odd = b"P6 # spp=3\n#wavetrace:partial=true\n\t1#a\n 1\r\n100\n\x00\x32\x64P6 1 1 255 abc";
    let found = folder.read(odd).unwrap();
    assert_eq!(found.image.pixels, [[0.0, at(50, 100), 1.0]]);
    assert_eq!((found.metadata.get("spp"), found.metadata.partial), (Some("3"), true));
    let deep = b"P6\n1 1\n65535\n\x01\x02\x00\x00\xff\xff";
    assert_eq!(folder.pixels(deep), [[at(258, 65535), 0.0, 1.0]]);
    assert_eq!(
        folder.pixels(b"P3\n2 1 15\n0 7 15\n# between\n 1 2\n3"),
        [[0.0, at(7, 15), 1.0], [at(1, 15), at(2, 15), at(3, 15)]]
    );
    folder.fails(b"P3\n1 1 15\n0 7 16\n", "a sample of 16");
    folder.fails(b"P6\n1 1\n100\n\x00\x65\x00", "a sample of 101");
    folder.fails(b"P3\n1 1 15\n0 x7 16\n", "a sample \"x7\"");
    folder.fails(b"P6\n1 -1\n255\nabc", "the height \"-1\"");
    folder.fails(b"P6\n1 1\n70000\nabc", "the largest value 70000, expected 1 to 65535");
    folder.fails(b"P6\n1 1\n0\nabc", "the largest value 0");
    folder.fails(b"P6\n0 1\n255\n", "an image of 0x1 pixels");
    folder.fails(b"P6\n2 1\n255\nabcde", "5 bytes of pixels, expected at least 6");
    folder.fails(b"P6\n2", "a file that ends early");
}

#[test]
fn hdr_of_every_kind() {
    let folder = Folder::new();
    // Run-length codes by channel, of an independent encoder: runs, changes, and rows too short for the code.
    for (width, height) in [(300_u32, 3_u32), (8, 2), (7, 2), (128, 1)] {
        let value = |i: u32| if (i / 20).is_multiple_of(2) { 0.75 } else { (i % 13) as f32 };
        let pixels: Vec<[f32; 3]> = (0..width * height).map(|i| [value(i), 0.5, value(2 * i)]).collect();
        let mut bytes = Vec::new();
        let encoder = image::codecs::hdr::HdrEncoder::new(&mut bytes);
        let raw = bytemuck::cast_slice(&pixels);
        image::ImageEncoder::write_image(encoder, raw, width, height, image::ExtendedColorType::Rgb32F).unwrap();
        let decoder = image::codecs::hdr::HdrDecoder::new(Cursor::new(&bytes)).unwrap();
        let mut expected = vec![[0_f32; 3]; pixels.len()];
        image::ImageDecoder::read_image(decoder, bytemuck::cast_slice_mut(&mut expected)).unwrap();
        assert_eq!(folder.pixels(&bytes), expected, "{width}x{height}");
    }
    // The older code by hand: a pixel, 2 more of it, another, and 1 + 256 more of that.
    let head = |size: &str| format!("#?RGBE\nFORMAT=32-bit_rle_rgbe\n\n{size}\n").into_bytes();
    let old = [128, 64, 32, 129, 1, 1, 1, 2, 0, 0, 128, 129, 1, 1, 1, 1, 1, 1, 1, 1];
    let pixels = folder.pixels(&[head("-Y 1 +X 261"), old.to_vec()].concat());
    assert_eq!(pixels[..3], [[1.0, 0.5, 0.25]; 3]);
    assert_eq!(pixels[3..], [[0.0, 0.0, 1.0]; 258]);
    // Values are divided by exposures and corrections, all of them.
    let header = b"#?RADIANCE\nEXPOSURE=2\n# a comment\nspp=9\nEXPOSURE= 4\nCOLORCORR=1 0.5 2\n\n-Y 1 +X 1\n";
    let found = folder.read(&[&header[..], &[128, 128, 128, 129]].concat()).unwrap();
    assert_eq!(found.image.pixels, [[1.0 / 8.0, 1.0 / 4.0, 1.0 / 16.0]]);
    assert_eq!(found.metadata.entries, [("spp".to_owned(), "9".to_owned())]);
    let found =
        folder.read(b"#?RADIANCE\nPRIMARIES=0.6 0.3 0.3 0.6 0.1 0.1 0.3 0.3\n\n-Y 1 +X 1\n\x80\x80\x80\x00").unwrap();
    assert_eq!(
        (found.image.pixels, found.remarks),
        (vec![[0.0; 3]], vec!["its primaries are taken as Rec. 709".to_owned()])
    );

    folder.fails(b"#?RADIANCE\nFORMAT=32-bit_rle_xyze\n\n-Y 1 +X 1\nabcd", "pixels of the format 32-bit_rle_xyze");
    folder.fails(b"#?RADIANCE\nEXPOSURE=0\n\n-Y 1 +X 1\nabcd", "EXPOSURE=0");
    folder.fails(b"#?RADIANCE\nCOLORCORR=1 2\n\n-Y 1 +X 1\nabcd", "COLORCORR=1 2");
    folder.fails(&head("+X 1 +Y 1"), "the resolution \"+X 1 +Y 1\"");
    folder.fails(&[head("-Y 1 +X 2"), vec![9, 9, 9, 9, 1, 1, 1, 2]].concat(), "a run of 2 pixels, expected at most 1");
    folder.fails(&[head("-Y 1 +X 9"), vec![2, 2, 0, 8]].concat(), "a row of 8 pixels, expected 9");
    folder.fails(&[head("-Y 1 +X 8"), vec![2, 2, 0, 8, 137, 0]].concat(), "a run of 9 pixels, expected 1 to 8");
    folder.fails(&[head("-Y 1 +X 8"), vec![2, 2, 0, 8, 0]].concat(), "a run of 0 pixels, expected 1 to 8");
    // Runs without end, of no pixels at all.
    folder.fails(&[head("-Y 1 +X 2"), vec![9; 4], [1, 1, 1, 0].repeat(99)].concat(), "a file that ends early");
}

mod openexr {
    use super::*;
    use exr::meta::attribute::Chromaticities;
    use exr::prelude::*;

    fn written<L>(image: &exr::image::Image<L>) -> Vec<u8>
    where
        for<'a> &'a exr::image::Image<L>: WriteImage,
    {
        WriteImage::bytes(image)
    }
    trait WriteImage {
        fn bytes(self) -> Vec<u8>;
    }
    impl<L> WriteImage for &exr::image::Image<L>
    where
        for<'a> L: exr::image::write::layers::WritableLayers<'a>,
    {
        fn bytes(self) -> Vec<u8> {
            let mut bytes = Cursor::new(Vec::new());
            self.write().non_parallel().to_buffered(&mut bytes).unwrap();
            bytes.into_inner()
        }
    }

    /// Any channels, each with its name and samples.
    fn channels(list: Vec<(&str, FlatSamples)>) -> AnyChannels<FlatSamples> {
        AnyChannels::sort(list.into_iter().map(|(name, samples)| AnyChannel::new(name, samples)).collect())
    }
    fn floats(values: &[[f32; 3]], k: usize) -> FlatSamples {
        FlatSamples::F32(values.iter().map(|v| v[k]).collect())
    }
    fn rgb(values: &[[f32; 3]]) -> Vec<(&'static str, FlatSamples)> {
        vec![("R", floats(values, 0)), ("G", floats(values, 1)), ("B", floats(values, 2))]
    }
    fn layer(
        size: (usize, usize),
        list: Vec<(&str, FlatSamples)>,
        encoding: Encoding,
    ) -> Layer<AnyChannels<FlatSamples>> {
        Layer::new(size, LayerAttributes::named("main"), encoding, channels(list))
    }

    fn by_the_crate(bytes: &[u8], width: usize) -> Vec<[f32; 3]> {
        let reader = read().no_deep_data().largest_resolution_level().rgb_channels(
            |size, _| vec![[0_f32; 3]; size.area()],
            move |pixels: &mut Vec<[f32; 3]>, at, (r, g, b): (f32, f32, f32)| {
                pixels[at.y() * width + at.x()] = [r, g, b]
            },
        );
        let image = reader.first_valid_layer().all_attributes().from_buffered(Cursor::new(bytes)).unwrap();
        image.layer_data.channel_data.pixels
    }

    /// Small files of the compressions that we do not write.
    pub fn small_files() -> Vec<(&'static str, Vec<u8>)> {
        use Compression::*;
        let scan =
            [("rle", RLE), ("piz", PIZ), ("pxr24", PXR24), ("b44", B44), ("dwaa", DWAA(None)), ("raw", Uncompressed)];
        let lines = scan.into_iter().map(|(name, compression)| (name, compression, Blocks::ScanLines));
        let tiles = [("tiles", ZIP1, Blocks::Tiles(Vec2(8, 8))), ("piz tiles", PIZ, Blocks::Tiles(Vec2(8, 4)))];
        let image = noise(13, 19);
        let file = |(name, compression, blocks)| {
            let encoding = Encoding { compression, blocks, line_order: LineOrder::Increasing };
            (name, written(&exr::image::Image::from_layer(layer((13, 19), rgb(&image.pixels), encoding))))
        };
        lines.chain(tiles).map(file).collect()
    }

    #[test]
    fn every_compression_and_tiling() {
        let folder = Folder::new();
        let image = noise(70, 45);
        // Halves, so that no compression but the lossy ones changes a bit.
        let halves: Vec<[f32; 3]> = image.pixels.iter().map(|p| p.map(|c| f16::from_f32(c).to_f32())).collect();
        let half = |k: usize| FlatSamples::F16(halves.iter().map(|v| f16::from_f32(v[k])).collect());
        for compression in [
            Compression::Uncompressed,
            Compression::RLE,
            Compression::ZIP1,
            Compression::ZIP16,
            Compression::PIZ,
            Compression::PXR24,
            Compression::B44,
            Compression::B44A,
        ] {
            for blocks in [Blocks::ScanLines, Blocks::Tiles(Vec2(32, 16))] {
                let encoding = Encoding { compression, blocks, line_order: LineOrder::Increasing };
                let list = vec![("R", half(0)), ("G", half(1)), ("B", half(2)), ("A", half(0))];
                let bytes = written(&exr::image::Image::from_layer(layer((70, 45), list, encoding)));
                let found = folder.pixels(&bytes);
                if matches!(compression, Compression::B44 | Compression::B44A) {
                    // Lossy: what the crate's own reader of colours makes of it.
                    assert_eq!(found, by_the_crate(&bytes, 70), "{compression:?} {blocks:?}");
                } else {
                    assert_eq!(found, halves, "{compression:?} {blocks:?}");
                }
            }
        }
    }

    /// The crate subtracts what it finds in a block of halves, which panics in builds that check arithmetic.
    #[test]
    fn b44_of_any_bytes() {
        let folder = Folder::new();
        let half = |k: usize| FlatSamples::F16(noise(8, 8).pixels.iter().map(|p| f16::from_f32(p[k])).collect());
        let encoding =
            Encoding { compression: Compression::B44, blocks: Blocks::ScanLines, line_order: LineOrder::Increasing };
        let list = vec![("R", half(0)), ("G", half(1)), ("B", half(2))];
        let mut bytes = written(&exr::image::Image::from_layer(layer((8, 8), list, encoding)));
        // Twelve squares, each of 14 bytes, end the file.
        let squares = bytes.len() - 12 * 14;
        let mut random = Random(44);
        let (mut read, mut refused) = (0, 0);
        for _ in 0..500 {
            for square in bytes[squares..].chunks_mut(14) {
                square.fill_with(|| (256.0 * random.unit()) as u8);
                // High values, mostly small differences.
                square[0] |= 0x80;
                square[2] &= 0x17;
            }
            match folder.read(&bytes) {
                Ok(file) => {
                    read += 1;
                    assert_eq!(bits(&file.image.pixels), bits(&by_the_crate(&bytes, 8)));
                }
                Err(error) => {
                    refused += 1;
                    assert!(error.to_string().contains("a B44 block with a sample below 0"), "{error}");
                }
            }
        }
        assert!(read > 50 && refused > 50, "{read} read, {refused} refused");
    }

    #[test]
    fn channels_are_found_by_name() {
        let folder = Folder::new();
        let encoding = Encoding::FAST_LOSSLESS;
        let (a, b) = (noise(6, 5).pixels, noise(5, 6).pixels);
        let read = |list| folder.read(&written(&exr::image::Image::from_layer(layer((6, 5), list, encoding))));
        // Luminance alone is grey.
        let grey: Vec<[f32; 3]> = a.iter().map(|p| [p[0]; 3]).collect();
        assert_eq!(read(vec![("Y", floats(&a, 0)), ("Z", floats(&b, 0))]).unwrap().image.pixels, grey);
        // Colours go before luminance and before other layers; layers where there is nothing else.
        let mut list = rgb(&a);
        list.extend([("Y", floats(&b, 0)), ("diffuse.R", floats(&b, 0))]);
        assert_eq!(read(list).unwrap().image.pixels, a);
        let layered = |name: [&'static str; 3], v| {
            name.into_iter().zip([0, 1, 2]).map(|(n, k)| (n, floats(v, k))).collect::<Vec<_>>()
        };
        let names = [["view.R", "view.G", "view.B"], ["variance.R", "variance.G", "variance.B"]];
        let found = read([layered(names[0], &a), layered(names[1], &b)].concat()).unwrap();
        assert_eq!((found.image.pixels, found.variance), (a.clone(), Some(b.clone())));
        assert_eq!(found.remarks, ["its colours are those of the layer of view.R"]);
        // Whole numbers are numbers.
        let whole = FlatSamples::U32((0..30).collect());
        assert_eq!(read(vec![("Y", whole)]).unwrap().image.pixels[29], [29.0; 3]);
        let error = read(vec![("depth.Z", floats(&a, 0)), ("A", floats(&a, 1))]).unwrap_err().to_string();
        assert!(error.contains("found the channels A, depth.Z, expected R, G and B, or Y"), "{error}");
        // Variances without colours are no image.
        assert!(read(layered(names[1], &b)).is_err());
    }

    #[test]
    fn parts_levels_and_windows() {
        let folder = Folder::new();
        let encoding = Encoding::FAST_LOSSLESS;
        let (a, b) = (noise(6, 5).pixels, noise(9, 4).pixels);
        let depth = layer((6, 5), vec![("Z", floats(&a, 0))], encoding);
        let mut colours = layer((9, 4), rgb(&b), encoding);
        colours.attributes.layer_name = Some("second".into());
        colours.attributes.layer_position = Vec2(-3, 7);
        let attributes = ImageAttributes::new(IntegerBounds::from_dimensions((20, 20)));
        let image = exr::image::Image::empty(attributes).with_layer(depth).with_layer(colours);
        let found = folder.read(&written(&image)).unwrap();
        assert_eq!((found.image.width, found.image.height, found.image.pixels), (9, 4, b));
        assert_eq!(found.remarks, ["its data window is taken, not its display window"]);
    }

    #[test]
    fn attributes_are_heeded_or_remarked_on() {
        let folder = Folder::new();
        let image = noise(6, 5);
        let mut first = layer((6, 5), rgb(&image.pixels), Encoding::FAST_LOSSLESS);
        let text = |text: &str| AttributeValue::Text(Text::from_slice_unchecked(text.as_bytes()));
        first.attributes.other.insert(Text::from("spp"), text("12"));
        first.attributes.other.insert(Text::from("a number"), AttributeValue::F32(1.0));
        let mut file = exr::image::Image::from_layer(first);
        file.attributes.other.insert(Text::from("wavetrace:partial"), text("true"));
        let pair = |x, y| Vec2(x, y);
        file.attributes.chromaticities = Some(Chromaticities {
            red: pair(0.7, 0.3),
            green: pair(0.3, 0.6),
            blue: pair(0.15, 0.06),
            white: pair(0.3127, 0.329),
        });
        let found = folder.read(&written(&file)).unwrap();
        assert_eq!(found.metadata, Metadata { entries: vec![("spp".to_owned(), "12".to_owned())], partial: true });
        assert_eq!(found.remarks, ["its primaries are taken as Rec. 709"]);
    }
}

#[test]
fn what_is_no_image_file_is_named() {
    let folder = Folder::new();
    folder.fails(b"", "an empty file");
    folder.fails(b"{\"camera\": {}}", "a file that begins with \"{\\\"camera");
    folder.fails(b"\xff\xd8\xff\xe0\0\x10JFIF", "a JPEG image");
    folder.fails(b"P5 1 1 255 a", "a Netpbm or PFM image of another kind");
    fs::create_dir(folder.path("b.png")).unwrap();
    let error = output::read(&folder.path("b.png")).unwrap_err().to_string();
    assert!(error.contains("b.png: found a folder, expected a PNG, PPM"), "{error}");
    let error = output::read(&folder.path("none.png")).unwrap_err().to_string();
    assert!(error.contains("none.png: cannot read: "), "{error}");
    if Path::new("/dev/zero").exists() {
        let error = output::read(Path::new("/dev/zero")).unwrap_err().to_string();
        assert!(error.contains("/dev/zero: found a file that begins with \"\\x00"), "{error}");
    }
}

/// One small file of each format, with all that we write.
fn small_files() -> Vec<(&'static str, Vec<u8>)> {
    let folder = Folder::new();
    let (image, variance) = (noise(11, 18), noise(18, 11).pixels);
    let layers = Layers { image: &image, variance: Some(&variance) };
    let own = ["png", "ppm", "exr", "hdr"].map(|ending| {
        let path = folder.path("a").with_extension(ending);
        output::write(&path, layers, &metadata(true), &Tone::default()).unwrap();
        (ending, fs::read(path).unwrap())
    });
    let mut runs = Vec::new();
    let encoder = image::codecs::hdr::HdrEncoder::new(&mut runs);
    image::ImageEncoder::write_image(
        encoder,
        bytemuck::cast_slice(&[[0.5_f32; 3]; 400]),
        100,
        4,
        image::ExtendedColorType::Rgb32F,
    )
    .unwrap();
    let plain = b"P3\n# c=1\n2 2\n255\n1 2 3 4 5 6 7 8 9 10 11 12\n".to_vec();
    own.into_iter().chain([("runs", runs), ("p3", plain)]).chain(openexr::small_files()).collect()
}

#[test]
fn a_file_that_is_cut_anywhere_is_refused() {
    let folder = Folder::new();
    for (name, bytes) in small_files() {
        assert!(folder.read(&bytes).is_ok(), "{name}");
        // The last number of a plain file may be cut and still be one.
        let whole = if name == "p3" { bytes.len() - 2 } else { bytes.len() };
        for length in 0..whole {
            let error = folder.read(&bytes[..length]).expect_err(name);
            assert!(matches!(error, Error::Decode { .. }), "{name} cut at {length}: {error}");
        }
    }
}

/// Damage in any place: bytes changed, removed, doubled. The pixel count is right or there is a message.
#[test]
fn a_damaged_file_is_read_or_refused() {
    let folder = Folder::new();
    let mut random = Random(7);
    for (name, bytes) in small_files() {
        for _ in 0..1000 {
            let mut damaged = bytes.clone();
            for _ in 0..=random.below(3) {
                let at = random.below(damaged.len());
                match random.below(4) {
                    0 => damaged[at] = random.bits() as u8,
                    1 => damaged[at] ^= 1 << random.below(8),
                    2 => drop(damaged.drain(at..(at + random.below(20)).min(damaged.len()))),
                    _ => {
                        let piece = damaged[at..(at + random.below(20)).min(damaged.len())].to_vec();
                        damaged.splice(at..at, piece);
                    }
                }
                if damaged.is_empty() {
                    damaged.push(0);
                }
            }
            if let Ok(found) = folder.read(&damaged) {
                let pixels = found.image.width as usize * found.image.height as usize;
                assert_eq!(found.image.pixels.len(), pixels, "{name}");
                assert!(found.variance.is_none_or(|v| v.len() == pixels), "{name}");
            }
        }
    }
}

/// A few bytes that claim an image of gigabytes take no memory for it.
#[cfg(target_os = "linux")]
#[test]
fn claims_are_not_believed() {
    use exr::math::RoundingMode;
    use exr::meta::BlockDescription;
    use exr::meta::attribute::{LevelMode, TileDescription};
    use exr::prelude::*;
    let peak = || {
        let status = fs::read_to_string("/proc/self/status").unwrap();
        let line = status.lines().find_map(|line| line.strip_prefix("VmPeak:")).unwrap();
        line.trim().trim_end_matches("kB").trim().parse::<u64>().unwrap() / 1024
    };
    let folder = Folder::new();
    let before = peak();
    for side in [16_384_u32, 60_000] {
        for (width, height) in [(side, side), (65_536, 4096)] {
            let text = format!("P6\n{width} {height}\n255\nabc");
            folder.fails(text.as_bytes(), "expected");
            folder.fails(text.replace("P6", "P3").as_bytes(), "expected");
            folder.fails(format!("#?RADIANCE\n\n-Y {height} +X {width}\nabcd").as_bytes(), "expected");
            let header = [&width.to_be_bytes()[..], &height.to_be_bytes(), &[16, 6, 0, 0, 0]].concat();
            for interlaced in [0, 1] {
                let mut header = header.clone();
                header[12] = interlaced;
                let data = chunk(b"IDAT", &deflated(&[0; 50]));
                folder.fails(&[&b"\x89PNG\r\n\x1a\n"[..], &chunk(b"IHDR", &header), &data].concat(), "expected");
            }
            let size = Vec2(width as usize, height as usize);
            for blocks in [Blocks::ScanLines, Blocks::Tiles(size), Blocks::Tiles(Vec2(16, 16))] {
                let channels = ["B", "G", "R"].map(|name| ChannelDescription::named(name, SampleType::F32));
                let header = exr::meta::header::Header::new("a".into(), size, channels.into_iter().collect())
                    .with_encoding(
                        Compression::PIZ,
                        match blocks {
                            Blocks::ScanLines => BlockDescription::ScanLines,
                            Blocks::Tiles(tile_size) => BlockDescription::Tiles(TileDescription {
                                tile_size,
                                level_mode: LevelMode::Singular,
                                rounding_mode: RoundingMode::Down,
                            }),
                        },
                        LineOrder::Increasing,
                    );
                let mut bytes = Vec::new();
                exr::meta::header::Header::write_all(&[header], &mut bytes, false).unwrap();
                let tiled = if blocks == Blocks::ScanLines { 0 } else { 2 };
                let start = [0x76, 0x2f, 0x31, 0x01, 2, tiled, 0, 0];
                // A table of offsets and a block, as far as they go.
                let rest: Vec<u8> = [&[0; 4000][..], &[255, 255, 255, 127].repeat(1000)].concat();
                folder.fails(&[&start[..], &bytes, &rest].concat(), "expected");
            }
        }
    }
    let taken = peak() - before;
    assert!(taken < 700, "{taken} MB");
}
