// KTX 2.0 by the libraries that web pages read it with. Usage: node ktx2.mjs read FILE | write DESCRIPTION.json FILE
import { readFileSync, writeFileSync } from 'node:fs';
import {
  KHR_DF_CHANNEL_RGBSDA_ALPHA,
  KHR_DF_CHANNEL_RGBSDA_BLUE,
  KHR_DF_CHANNEL_RGBSDA_GREEN,
  KHR_DF_CHANNEL_RGBSDA_RED,
  KHR_DF_MODEL_RGBSDA,
  KHR_DF_SAMPLE_DATATYPE_FLOAT,
  KHR_DF_SAMPLE_DATATYPE_LINEAR,
  KHR_DF_SAMPLE_DATATYPE_SIGNED,
  KHR_DF_TRANSFER_LINEAR,
  KHR_DF_TRANSFER_SRGB,
  KHR_SUPERCOMPRESSION_ZSTD,
  VK_FORMAT_R8G8B8A8_SRGB,
  VK_FORMAT_R16G16B16A16_SFLOAT,
  createDefaultContainer,
  read,
  write,
} from 'ktx-parse';
import { ZSTDDecoder } from 'zstddec';

const base64 = (bytes) => Buffer.from(bytes).toString('base64');

async function describe(file) {
  const { levels, keyValue, dataFormatDescriptor, ...head } = read(new Uint8Array(readFileSync(file)));
  const isPacked = head.supercompressionScheme === KHR_SUPERCOMPRESSION_ZSTD;
  const unpacker = new ZSTDDecoder();
  if (isPacked) await unpacker.init();
  const unpack = ({ levelData, uncompressedByteLength }) =>
    isPacked ? unpacker.decode(levelData, uncompressedByteLength) : levelData;
  const values = Object.entries(keyValue).map(([key, value]) => [
    key,
    typeof value === 'string' ? value : new TextDecoder('utf-8', { fatal: true }).decode(value),
  ]);
  return {
    ...head,
    dataFormatDescriptor,
    keyValue: Object.fromEntries(values),
    levels: levels.map((level) => base64(unpack(level))),
  };
}

// RGBA texels as the format's own documentation describes them.
function texelDescriptor(isHalf) {
  const bits = isHalf ? 16 : 8;
  const channels = [
    KHR_DF_CHANNEL_RGBSDA_RED,
    KHR_DF_CHANNEL_RGBSDA_GREEN,
    KHR_DF_CHANNEL_RGBSDA_BLUE,
    KHR_DF_CHANNEL_RGBSDA_ALPHA,
  ];
  const half = KHR_DF_SAMPLE_DATATYPE_SIGNED | KHR_DF_SAMPLE_DATATYPE_FLOAT;
  const plain = (channel) => (channel === KHR_DF_CHANNEL_RGBSDA_ALPHA ? KHR_DF_SAMPLE_DATATYPE_LINEAR : 0);
  return {
    ...createDefaultContainer().dataFormatDescriptor[0],
    colorModel: KHR_DF_MODEL_RGBSDA,
    transferFunction: isHalf ? KHR_DF_TRANSFER_LINEAR : KHR_DF_TRANSFER_SRGB,
    bytesPlane: [bits / 2, 0, 0, 0, 0, 0, 0, 0],
    samples: channels.map((channel, number) => ({
      bitOffset: bits * number,
      bitLength: bits - 1,
      channelType: channel | (isHalf ? half : plain(channel)),
      samplePosition: [0, 0, 0, 0],
      sampleLower: isHalf ? 0xbf800000 : 0,
      sampleUpper: isHalf ? 0x3f800000 : 255,
    })),
  };
}

function build({ size, depth, isHalf, levels, keyValue }) {
  const texels = levels.map((level) => new Uint8Array(Buffer.from(level, 'base64')));
  return write({
    ...createDefaultContainer(),
    vkFormat: isHalf ? VK_FORMAT_R16G16B16A16_SFLOAT : VK_FORMAT_R8G8B8A8_SRGB,
    typeSize: isHalf ? 2 : 1,
    pixelWidth: size,
    pixelHeight: size,
    pixelDepth: depth,
    levelCount: texels.length,
    levels: texels.map((levelData) => ({ levelData, uncompressedByteLength: levelData.byteLength })),
    dataFormatDescriptor: [texelDescriptor(isHalf)],
    keyValue,
  });
}

const [verb, first, second] = process.argv.slice(2);
if (verb === 'read') {
  process.stdout.write(JSON.stringify(await describe(first)));
} else {
  writeFileSync(second, build(JSON.parse(readFileSync(first, 'utf-8'))));
}
